// SPDX-License-Identifier: Apache-2.0
// Hidden reflectors: recovers mirrors of each family from their far field alone, starting from the plain
// paraboloid, and prints what a re-trace with independent rays says of the result.
//   bench_design [-nTARGETS] [-v] [--first N] [--seed S] [--slower X] [--device cuda] [case ...]
// cases: n10-near n10 n49-near n49-far n49-wild n400. --first: leaves out the targets before the N-th;
// --seed: of the design's own random tries; --slower: X times the seconds, for a machine or build so much
// slower
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/design/fit.h"
#include "lucerna/design/optimizer.h"
#include "lucerna/design/window.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace/accelerator.h"

using namespace lucerna;

namespace {

struct Suite {
  std::string name;
  bool revolution;
  int intervals;
  double size_mm;    ///< coefficients are uniform in +- this
  double low, high;  ///< relative RMS of the start that a hidden target must have
  double bar, seconds;
  int restarts;
};

PlacedSource cylinder() {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  return {make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 15}), {}};
}

DesignShape plain(const Suite& s) {
  return s.revolution ? DesignShape::revolution(15, Aperture::circle(100), s.intervals)
                      : DesignShape::bspline(15, Aperture::rectangle(100, 100), s.intervals, s.intervals);
}

DesignShape hidden(const Suite& s, std::uint64_t seed) {
  const DesignShape shape = plain(s);
  Eigen::VectorXd p = shape.parameters();
  Rng rng(seed, 0);
  for (double& x : p) x = s.size_mm * (2.0 * rng.uniform() - 1.0);
  return shape.with(p);
}

double seconds_since(std::chrono::steady_clock::time_point t) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - t).count();
}
double cpu_seconds() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Run {
  int targets = 10, first = 1;
  std::uint64_t seed = 1;
  double slower = 1.0;
  bool verbose = false;
  std::shared_ptr<Accelerator> device;
};

struct Outcome {
  double start = 0.0, error = 0.0, floor = 0.0, excess = 0.0, wall = 0.0, cpu = 0.0;
  double rays = 0.0;
  int evaluations = 0;
};

constexpr std::uint64_t kTruthRays = 1 << 22;

EvaluationOptions reflected_only(std::uint64_t rays) {
  EvaluationOptions o;
  o.rays = rays;
  o.derivatives = false;
  o.direct_light = false;
  return o;
}

/// The hidden mirror's light as well as it can be known: mean of four independent runs, so that the floor of
/// a comparison is nearly that of the result's re-trace alone.
Evaluation well_known(const DesignShape& truth, const TentBins& bins, std::uint64_t seed) {
  constexpr int kRuns = 4;
  Evaluation mean;
  for (int run = 0; run < kRuns; ++run) {
    DesignRays rays({cylinder()}, Frame(), 5000 + 10 * seed + static_cast<std::uint64_t>(run));
    rays.grow(kTruthRays);
    const Evaluation e = evaluate(truth, Reflectance(1.0), rays, bins, reflected_only(kTruthRays));
    if (run == 0) {
      mean = e;
    } else {
      mean.flux += e.flux;
      mean.variance += e.variance;
    }
  }
  mean.flux /= kRuns;
  mean.variance /= kRuns * kRuns;
  return mean;
}

/// The window of the hidden mirror's light.
TentBins window(const Suite& s, const DesignShape& truth, const DesignRays& rays) {
  const TentBins all = TentBins::square(Frame(), 1.0, 400);
  const Evaluation e = evaluate(truth, Reflectance(1.0), rays, all, reflected_only(1 << 18));
  std::vector<DirectedFlux> light;
  for (int j = 0; j < 400; ++j) {
    for (int i = 0; i < 400; ++i) {
      const double u = (i + 0.5) / 200.0 - 1.0, v = (j + 0.5) / 200.0 - 1.0;
      const double flux = e.flux[j * 400 + i];
      if (u * u + v * v < 1.0 && flux > 0.0) {
        light.push_back({Direction::from_unit({u, v, std::sqrt(1.0 - u * u - v * v)}), flux});
      }
    }
  }
  return s.revolution ? ring_window(light, Direction()) : square_window(light, Direction());
}

/// Light of a hidden mirror by bins, made when first asked for; what that took is no part of a design.
class HiddenLight {
 public:
  HiddenLight(const DesignShape& truth, const DesignRays& rays) : truth_(truth), rays_(rays) {}

  const Eigen::VectorXd& operator()(const TentBins& b) {
    Eigen::VectorXd& flux = known_[{b.count(), b.extent()}];
    if (flux.size() > 0) return flux;
    const auto from = std::chrono::steady_clock::now();
    const double from_cpu = cpu_seconds();
    flux = evaluate(truth_, Reflectance(1.0), rays_, b, reflected_only(kTruthRays)).flux;
    wall_s_ += seconds_since(from);
    cpu_s_ += cpu_seconds() - from_cpu;
    return flux;
  }
  double wall_s() const { return wall_s_; }
  double cpu_s() const { return cpu_s_; }

 private:
  const DesignShape& truth_;
  const DesignRays& rays_;
  std::map<std::pair<int, double>, Eigen::VectorXd> known_;
  double wall_s_ = 0.0, cpu_s_ = 0.0;
};

void print_starts(const std::vector<FitStart>& starts) {
  for (const FitStart& f : starts) {
    fmt::print("  start{} {:.4f}\n",
               f.entry == FitEntry::few_knots ? " (plain)"
               : f.entry == FitEntry::end     ? " (profile)"
                                              : "",
               std::sqrt(f.cost));
  }
}

void print_step(const FitRecord& r, double seconds) {
  fmt::print("  stage {} step {:2} rays {:8} error {:.5f} floor {:.5f} lambda {:.1e} {} {:.2f} s\n", r.stage,
             r.step, r.rays, r.error, r.floor, r.lambda, r.accepted ? "" : "refused", seconds);
  std::fflush(stdout);
}

/// By rays that no fit has seen.
void judge(const DesignShape& found, const DesignShape& truth, const TentBins& bins, std::uint64_t seed,
           Outcome& out) {
  DesignRays rays({cylinder()}, Frame(), 777 + seed);
  rays.grow(kTruthRays);
  const Evaluation target = well_known(truth, bins, seed);
  const Evaluation result = evaluate(found, Reflectance(1.0), rays, bins, reflected_only(kTruthRays));
  const BinError error = bin_error(result, target.flux, bins, TargetMode::absolute);
  const BinError noise = bin_error(target, target.flux, bins, TargetMode::absolute);
  out.error = error.relative_rms;
  out.floor = std::hypot(error.floor, noise.floor);
  out.excess = std::sqrt(std::max(0.0, out.error * out.error - out.floor * out.floor));
}

/// Whether the start is as far from the hidden mirror of this seed as the suite asks for.
bool solve(const Suite& s, std::uint64_t seed, const Run& run, bool only_look, Outcome& out) {
  const DesignShape truth = hidden(s, seed);
  DesignRays truth_rays({cylinder()}, Frame(), 1000 + seed);
  truth_rays.grow(kTruthRays);
  const TentBins bins = window(s, truth, truth_rays);
  const Reflectance mirror(1.0);
  FitProblem problem{nullptr, mirror, {}, bins, TargetMode::absolute, false};

  HiddenLight light(truth, truth_rays);
  problem.target = std::ref(light);
  const Evaluation rough = evaluate(truth, mirror, truth_rays, bins, reflected_only(kTruthRays));
  const BinError start = bin_error(evaluate(plain(s), mirror, truth_rays, bins, reflected_only(1 << 18)),
                                   rough.flux, bins, TargetMode::absolute);
  out.start = start.relative_rms;
  if (out.start < s.low || out.start > s.high) return false;
  if (only_look) return true;

  const auto clock = std::chrono::steady_clock::now();
  const double cpu = cpu_seconds();
  DesignRays rays({cylinder()}, Frame(), 5);
  rays.evaluate_on(run.device);
  problem.rays = &rays;
  problem.max_failed_restarts = s.restarts;
  problem.seed = run.seed;
  const DesignShape begin = plain(s);
  const bool far = out.start > 0.2 || s.revolution;
  const std::vector<FitStage> stages = ladder(begin, bins, {LadderOptions{}.rays, far, 0});
  std::vector<double> search_costs;
  if (far) {
    prepare_starts(problem, begin, stages, optimizer("auto"), search_costs,
                   [](const FitRecord&, const DesignShape&) { return true; });
  }
  if (run.verbose) print_starts(problem.starts);
  Fit fit(problem, stages, begin, search_costs);
  // Seconds of two idle cores: what the clock says, or what processors were given on a shared machine.
  constexpr double kTwoCores = 1.8;
  const auto spent = [&] {
    return std::min(seconds_since(clock) - light.wall_s(), (cpu_seconds() - cpu - light.cpu_s()) / kTwoCores);
  };
  double per_ray = 0.0;  // of the last step; one more has to fit
  while (!fit.done() && spent() + per_ray * static_cast<double>(fit.next_rays()) < run.slower * s.seconds) {
    const double before = spent();
    const std::uint64_t rays_before = fit.state().total_rays;
    const FitRecord r = fit.step();
    per_ray =
        (spent() - before) / static_cast<double>(std::max<std::uint64_t>(r.total_rays - rays_before, 1));
    if (run.verbose) print_step(r, seconds_since(clock) - light.wall_s());
  }
  out.wall = spent();
  out.cpu = cpu_seconds() - cpu - light.cpu_s();
  out.rays = static_cast<double>(fit.state().total_rays);
  out.evaluations = fit.state().evaluations;
  judge(fit.best(), truth, bins, seed, out);
  return true;
}

double median(std::vector<double> v) {
  std::sort(v.begin(), v.end());
  const std::size_t n = v.size();
  return n % 2 == 1 ? v[n / 2] : 0.5 * (v[n / 2 - 1] + v[n / 2]);
}

void run(const Suite& s, const Run& run) {
  std::vector<Outcome> outcomes;
  int target = 0;
  for (std::uint64_t seed = 1; target < run.targets && seed < 400; ++seed) {
    Outcome o;
    if (!solve(s, seed, run, target + 1 < run.first, o) || ++target < run.first) continue;
    outcomes.push_back(o);
    fmt::print(
        "{:9} target {:2} (seed {:3}): start {:6.2f} %  result {:7.3f} %  floor {:.3f} %  excess {:6.3f} %  "
        "{:6.2f} s, {:6.2f} s cpu  {:3} evaluations  {:.1f} M rays\n",
        s.name, target, seed, 100 * o.start, 100 * o.error, 100 * o.floor, 100 * o.excess, o.wall, o.cpu,
        o.evaluations, 1e-6 * o.rays);
    std::fflush(stdout);
  }
  const auto of = [&](auto member) {
    std::vector<double> v;
    v.reserve(outcomes.size());
    for (const Outcome& o : outcomes) v.push_back(o.*member);
    return v;
  };
  const std::vector<double> errors = of(&Outcome::error), walls = of(&Outcome::wall),
                            excess = of(&Outcome::excess);
  if (outcomes.empty()) return;
  fmt::print(
      "{:9} median {:.3f} %, worst {:.3f} %; excess median {:.3f} %, worst {:.3f} %, bar {} %; seconds "
      "median {:.2f}, worst {:.2f}, bar {}\n\n",
      s.name, 100 * median(errors), 100 * *std::max_element(errors.begin(), errors.end()),
      100 * median(excess), 100 * *std::max_element(excess.begin(), excess.end()), 100 * s.bar, median(walls),
      *std::max_element(walls.begin(), walls.end()), s.seconds);
}

}  // namespace

int main(int argc, char** argv) {
  const std::vector<Suite> suites{
      {"n10-near", true, 8, 0.5, 0.05, 0.25, 0.005, 10, 6},
      {"n10", true, 8, 1.0, 0.25, 0.5, 0.005, 10, 10},
      {"n49-near", false, 4, 0.5, 0.05, 0.15, 0.005, 5, 2},
      {"n49-far", false, 4, 2.0, 0.25, 0.5, 0.015, 20, 4},
      {"n49-wild", false, 4, 5.0, 0.5, 10.0, 0.015, 20, 6},
      {"n400", false, 17, 2.0, 0.0, 10.0, 0.02, 60, 4},
  };
  Run options;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "-v") {
      options.verbose = true;
    } else if (a == "--first" && i + 1 < argc) {
      options.first = std::stoi(argv[++i]);
    } else if (a == "--seed" && i + 1 < argc) {
      options.seed = std::stoull(argv[++i]);
    } else if (a == "--slower" && i + 1 < argc) {
      options.slower = std::stod(argv[++i]);
    } else if (a == "--device" && i + 1 < argc && std::string(argv[i + 1]) == "cuda") {
      ++i;
      auto found = cuda_accelerators();
      if (found.empty()) {
        fmt::print("{}\n", why_no_cuda());
        return 1;
      }
      options.device = std::move(found.front());
    } else if (a.rfind("-n", 0) == 0) {
      options.targets = std::stoi(a.substr(2));
    } else {
      names.push_back(a);
    }
  }
  for (const Suite& s : suites) {
    if (names.empty() || std::find(names.begin(), names.end(), s.name) != names.end()) run(s, options);
  }
}
