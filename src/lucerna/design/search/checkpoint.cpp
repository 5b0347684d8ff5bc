// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/checkpoint.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr const char* kMagic = "lucerna-design-checkpoint-9";
constexpr const char* kSearchMagic = "lucerna-search-checkpoint-5";
/// More numbers than any design has; keeps a damaged count from asking for memory.
constexpr std::size_t kMaxNumbers = 1 << 20;
/// A square of so many intervals has about as many coefficients.
constexpr int kMaxIntervals = 1020;
/// More steps, rounds or evaluations than any design makes; one more is still an int.
constexpr int kMaxCount = 1 << 30;

[[noreturn]] void damaged(std::string_view what) {
  throw InputError(fmt::format("checkpoint: {}; expected a whole one written by this version", what),
                   ErrorCause::damaged);
}

class Reader {
 public:
  explicit Reader(const std::string& text) : in_(text) {}

  std::string word() {
    std::string w;
    if (!(in_ >> w)) damaged("it ends too early");
    return w;
  }
  void expect(const char* name) {
    if (word() != name) damaged("a field is missing");
  }
  template <class T>
  T number(const char* name) {
    expect(name);
    return value<T>();
  }
  int count(const char* name, int min = 0, int max = kMaxCount) {
    expect(name);
    return whole(min, max);
  }
  std::vector<double> numbers(const char* name) {
    expect(name);
    const auto n = value<std::size_t>();
    if (n > kMaxNumbers) damaged("a count is out of range");
    std::vector<double> v;
    for (std::size_t i = 0; i < n; ++i) v.push_back(value<double>());
    return v;
  }
  FitSnapshot snapshot(const char* name) {
    expect(name);
    FitSnapshot m;
    m.cost = value<double>();
    m.merit = value<double>();
    m.error_to_noise = value<double>();
    m.intervals_x = whole(1, kMaxIntervals);
    m.intervals_y = whole(0, kMaxIntervals);  // 0: of revolution
    m.parameters = numbers("of");
    return m;
  }
  FreeFormSnapshot search_snapshot(const char* name) {
    expect(name);
    FreeFormSnapshot m;
    m.candidate = whole(-1, kMaxCount);
    m.level = whole(m.exists() ? 0 : -1, kFreeFormLevels - 1);
    m.transport.sign = value<double>();
    m.transport.vertex_distance_mm = value<double>();
    m.cost = value<double>();
    m.error = value<double>();
    m.early_cost = value<double>();
    m.error_to_noise = value<double>();
    m.intervals_x = whole(1, kMaxIntervals);
    m.intervals_y = whole(1, kMaxIntervals);
    m.bins = whole(1, kMaxIntervals);
    m.derivative_noise = value<double>();
    m.derivative_rays = value<std::uint64_t>();
    m.parameters = numbers("of");
    return m;
  }
  /// Magic and key.
  void header(const char* magic, const std::string& key) {
    if (word() != magic) damaged("it does not begin like one");
    expect("key");
    if (word() != key) {
      throw InputError(
          "checkpoint: belongs to another project, seed, ray count or device; start without resuming",
          ErrorCause::mismatch);
    }
  }

 private:
  template <class T>
  T value() {
    const std::string w = word();
    T t{};
    const auto [end, error] = std::from_chars(w.data(), w.data() + w.size(), t);
    if (error != std::errc() || end != w.data() + w.size()) damaged("a number cannot be read");
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(t)) damaged("a number is not finite");
    }
    return t;
  }
  int whole(int min, int max) {
    const auto n = value<int>();
    if (n < min || n > max) damaged(fmt::format("found {}, expected {} to {}", n, min, max));
    return n;
  }
  std::istringstream in_;
};

void put(std::string& text, const char* name, const std::vector<double>& v) {
  text += fmt::format("{} {}", name, v.size());
  for (const double x : v) text += fmt::format(" {}", x);  // the shortest text of the same double
  text += '\n';
}

void put(std::string& text, const char* name, const FitSnapshot& m) {
  text += fmt::format("{} {} {} {} {} {} ", name, m.cost, m.merit, m.error_to_noise, m.intervals_x,
                      m.intervals_y);
  put(text, "of", m.parameters);
}

void put(std::string& text, const char* name, const FreeFormSnapshot& m) {
  text +=
      fmt::format("{} {} {} {} {} {} {} {} {} {} {} {} {} {} ", name, m.candidate, m.level, m.transport.sign,
                  m.transport.vertex_distance_mm, m.cost, m.error, m.early_cost, m.error_to_noise,
                  m.intervals_x, m.intervals_y, m.bins, m.derivative_noise, m.derivative_rays);
  put(text, "of", m.parameters);
}

}  // namespace

std::string checkpoint_text(const FreeFormState& s, const std::string& key) {
  std::string text = fmt::format(
      "{}\nkey {}\nstep {}\nrefused {}\nlambda {}\nbegun {}\nfailed {}\nevaluations {}\n"
      "total_rays {}\n",
      kSearchMagic, key, s.step, s.refused, s.lambda, s.begun, s.failed, s.evaluations, s.total_rays);
  put(text, "costs", s.costs);
  put(text, "now", s.now);
  text += fmt::format("done {}\n", s.done.size());
  for (const FreeFormSnapshot& m : s.done) put(text, "mark", m);
  return text + "end\n";
}

FreeFormState parse_search_checkpoint(const std::string& text, const std::string& key) {
  Reader in(text);
  in.header(kSearchMagic, key);
  FreeFormState s;
  s.step = in.count("step");
  s.refused = in.count("refused");
  s.lambda = in.number<double>("lambda");
  s.begun = in.count("begun");
  s.failed = in.count("failed");
  s.evaluations = in.count("evaluations");
  s.total_rays = in.number<std::uint64_t>("total_rays");
  s.costs = in.numbers("costs");
  s.now = in.search_snapshot("now");
  const auto snapshots = in.number<std::size_t>("done");
  if (snapshots > kMaxNumbers) damaged("a count is out of range");
  for (std::size_t i = 0; i < snapshots; ++i) s.done.push_back(in.search_snapshot("mark"));
  in.expect("end");
  return s;
}

std::string checkpoint_text(const FitState& s, const std::string& key) {
  const RestartState& r = s.restart;
  std::string text = fmt::format(
      "{}\nkey {}\nintervals_x {}\nintervals_y {}\nstage {}\nstep {}\nlambda {}\nevaluations {}\n"
      "total_rays {}\nover_noise {}\nstarts {}\nfailed_restarts {}\nrefused {}\nsearch_restarts {}\n"
      "search_restarts_left {}\ntwin {}\nincumbent_cost {}\n",
      kMagic, key, s.intervals_x, s.intervals_y, s.stage, s.step, s.lambda, s.evaluations, s.total_rays,
      s.error_to_noise, r.begun, r.failed, s.refused, r.searches, r.searches_left, r.conjugate ? 1 : 0,
      r.incumbent_cost);
  put(text, "parameters", s.parameters);
  put(text, "costs", s.costs);
  put(text, "gate", r.screened);
  put(text, "best", r.best);
  put(text, "found", r.found);
  put(text, "search_costs", s.search_costs);
  return text + "end\n";
}

FitState parse_checkpoint(const std::string& text, const std::string& key) {
  Reader in(text);
  in.header(kMagic, key);
  FitState s;
  s.intervals_x = in.count("intervals_x", 1, kMaxIntervals);
  s.intervals_y = in.count("intervals_y", 0, kMaxIntervals);
  s.stage = in.count("stage");
  s.step = in.count("step");
  s.lambda = in.number<double>("lambda");
  s.evaluations = in.count("evaluations");
  s.total_rays = in.number<std::uint64_t>("total_rays");
  s.error_to_noise = in.number<double>("over_noise");
  s.restart.begun = in.count("starts");
  s.restart.failed = in.count("failed_restarts");
  s.refused = in.count("refused");
  s.restart.searches = in.count("search_restarts");
  s.restart.searches_left = in.count("search_restarts_left");
  s.restart.conjugate = in.count("twin", 0, 1) != 0;
  s.restart.incumbent_cost = in.number<double>("incumbent_cost");
  s.parameters = in.numbers("parameters");
  s.costs = in.numbers("costs");
  s.restart.screened = in.snapshot("gate");
  s.restart.best = in.snapshot("best");
  s.restart.found = in.snapshot("found");
  s.search_costs = in.numbers("search_costs");
  in.expect("end");
  return s;
}

int checkpoint_evaluations(const std::string& text) {
  constexpr std::string_view kKey = "\nkey ";
  const std::size_t at = text.find(kKey);
  if (at == std::string::npos) damaged("it has no key");
  const std::size_t from = at + kKey.size(), end = text.find('\n', from);
  const std::string key = text.substr(from, end - from);
  if (text.starts_with(kSearchMagic)) return parse_search_checkpoint(text, key).evaluations;
  const FitState state = parse_checkpoint(text, key);
  return std::max(state.evaluations, static_cast<int>(state.search_costs.size()));
}

}  // namespace lucerna
