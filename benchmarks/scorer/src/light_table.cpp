// SPDX-License-Identifier: Apache-2.0
#include "light_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>

namespace bench {

namespace {

/// A ratio of light, in per cent, is often rounded.
constexpr double kRatioTolerance = 0.01;
/// Smaller intensities are no light: their squares would be none.
constexpr double kDark = 1e-100;

/// Lines of an LDT file, one after another, each with its number.
class LdtFile {
 public:
  explicit LdtFile(const std::string& file) : file_(file), in_(file, std::ios::binary) {
    if (!in_) throw InputError(file, "file", "nothing that can be opened", "an LDT file");
  }

  void skip(int lines) {
    for (int i = 0; i < lines; ++i) next("a line");
  }
  double number(double low, double high, const char* what) {
    std::string text = next(what);
    const auto first = text.find_first_not_of(" \t"), last = text.find_last_not_of(" \t\r");
    text = first == std::string::npos ? "" : text.substr(first, last - first + 1);
    double x = 0.0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), x);
    if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !(x >= low && x <= high))
      fail(text.empty() ? "an empty line" : text.substr(0, 60), what);
    return x;
  }
  int whole(int low, int high, const char* what) {
    const double x = number(low, high, what);
    if (x != std::floor(x)) fail("a number that is not whole", what);
    return static_cast<int>(x);
  }
  /// Nothing but blank lines may follow.
  void end() {
    for (std::string text; std::getline(in_, text);) {
      ++line_;
      if (text.find_first_not_of(" \t\r\n\x1a") != std::string::npos)
        fail("more lines", "the end of the file");
    }
  }
  [[noreturn]] void fail(const std::string& found, const std::string& expected) const {
    fail_at("line " + std::to_string(line_), found, expected);
  }
  [[noreturn]] void fail_at(const std::string& place, const std::string& found,
                            const std::string& expected) const {
    throw InputError(file_, place, found, expected);
  }

 private:
  std::string next(const char* what) {
    ++line_;
    std::string text;
    if (!std::getline(in_, text)) fail("the end of the file", what);
    return text;
  }

  std::string file_;
  std::ifstream in_;
  int line_ = 0;
};

/// Intensities along gamma, in both halves of the plane y = 0.
struct Halves {
  std::vector<double> gamma, c0, c180;
};

/// How many planes a file stores, and which of them are C0 and C180.
struct Planes {
  std::size_t stored, c0, c180;
};

/// By the symmetry that line 3 names and the angles of all C planes.
Planes planes_of(LdtFile& in, int symmetry, const std::vector<double>& c) {
  const std::size_t n = c.size();
  const auto fail = [&] {
    in.fail_at(
        "C planes",
        std::to_string(n) + " planes that do not lie as symmetry " + std::to_string(symmetry) + " says",
        "planes at C0 and C180, or at the quarters that it needs");
  };
  // Is there a plane at each of the parts of a turn, where even planes have it?
  const auto divided = [&](std::size_t parts) {
    if (n % parts != 0) fail();
    for (std::size_t k = 0; k < parts; ++k) {
      if (std::abs(c[k * n / parts] - 360.0 * static_cast<double>(k) / static_cast<double>(parts)) > 1e-6)
        fail();
    }
  };
  if (symmetry == 0) {
    const auto half = std::find(c.begin(), c.end(), 180.0);
    if (c.front() != 0.0 || half == c.end()) fail();
    return {n, 0, static_cast<std::size_t>(half - c.begin())};
  }
  if (symmetry == 1) return {1, 0, 0};
  divided(symmetry == 2 ? 2 : 4);
  // C0 to C180; C270 over C0 to C90; C0 to C90.
  if (symmetry == 2) return {n / 2 + 1, 0, n / 2};
  if (symmetry == 3) return {n / 2 + 1, n / 4, n / 4};
  return {n / 4 + 1, 0, 0};
}

std::vector<double> ascending(LdtFile& in, std::size_t count, double high, const char* what) {
  std::vector<double> out;
  for (std::size_t i = 0; i < count; ++i) {
    out.push_back(in.number(0.0, high, what));
    if (i > 0 && !(out[i] > out[i - 1])) in.fail(shown(out[i]), "an angle above the one before");
  }
  return out;
}

Halves read_halves(const std::string& file) {
  LdtFile in(file);
  in.skip(2);
  const int symmetry = in.whole(0, 4, "a symmetry from 0 to 4");
  const int planes = in.whole(1, 721, "the number of C planes, 1 to 721");
  in.skip(1);
  const int gammas = in.whole(2, 7201, "the number of gammas, 2 to 7201");
  // Distance of gammas, texts, sizes, the share that goes down.
  in.skip(1 + 5 + 10);
  const double ratio = in.number(0.0, 1000.0, "a light output ratio");
  if (std::abs(ratio - 100.0) > kRatioTolerance) in.fail(shown(ratio), "100: the table has all light");
  in.skip(2);
  in.skip(6 * in.whole(0, 20, "the number of sets of lamps, 0 to 20") + 10);
  const auto c = ascending(in, static_cast<std::size_t>(planes), 360.0, "an angle of a C plane");
  Halves out;
  out.gamma = ascending(in, static_cast<std::size_t>(gammas), 180.0, "a gamma from 0 to 180");
  if (out.gamma.front() > 0.0)
    in.fail_at("gammas", shown(out.gamma.front()) + " as the first", "0: they begin at -z");
  const Planes which = planes_of(in, symmetry, c);
  for (std::size_t k = 0; k < which.stored; ++k) {
    std::vector<double> row;
    for (int i = 0; i < gammas; ++i) row.push_back(in.number(0.0, 1e12, "an intensity from 0 to 1e12"));
    if (k == which.c0) out.c0 = row;
    if (k == which.c180) out.c180 = row;
  }
  in.end();
  const double peak = std::max(*std::max_element(out.c0.begin(), out.c0.end()),
                               *std::max_element(out.c180.begin(), out.c180.end()));
  if (!(peak > kDark)) in.fail_at("intensities", "no light in C0 and C180", "a table with light");
  for (double& x : out.c0) x /= peak;
  for (double& x : out.c180) x /= peak;
  return out;
}

class LightTable final : public Source {
 public:
  explicit LightTable(const Halves& halves) {
    for (std::size_t i = halves.gamma.size(); i-- > 0;) add(-halves.gamma[i], halves.c180[i]);
    for (std::size_t i = 0; i < halves.gamma.size(); ++i) add(halves.gamma[i], halves.c0[i]);
    below_.push_back(0.0);
    for (std::size_t i = 1; i < angle_.size(); ++i)
      below_.push_back(below_.back() + 0.5 * (light_[i - 1] + light_[i]) * (angle_[i] - angle_[i - 1]));
  }

  SourceRay ray(std::uint64_t, RayRandom& random) const override {
    const double angle = kDegree * angle_at(random.uniform() * below_.back());
    return {{}, {std::sin(angle), 0.0, -std::cos(angle)}, 1.0};
  }

 private:
  void add(double angle, double light) {
    angle_.push_back(angle);
    light_.push_back(light);
  }

  /// Where so much of the light is below.
  double angle_at(double below) const {
    const auto above = std::upper_bound(below_.begin(), below_.end(), below);
    const auto i = std::min<std::size_t>(static_cast<std::size_t>(above - below_.begin()), below_.size() - 1);
    const double width = angle_[i] - angle_[i - 1], a = light_[i - 1], b = light_[i];
    const double rest = below - below_[i - 1];
    if (width <= 0.0) return angle_[i];
    // a x + (b - a) x^2 / (2 width) = rest, in the form that needs no division by b - a.
    const double root = std::sqrt(std::max(0.0, a * a + 2.0 * (b - a) / width * rest));
    return angle_[i - 1] + std::min(width, a + root > 0.0 ? 2.0 * rest / (a + root) : 0.0);
  }

  std::vector<double> angle_, light_, below_;
};

}  // namespace

std::unique_ptr<Source> read_light_table(const std::string& file) {
  return std::make_unique<LightTable>(read_halves(file));
}

}  // namespace bench
