// SPDX-License-Identifier: Apache-2.0
// Do the stated intervals hold the truth? Many short traces of three mirrors against a long one.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <map>
#include <string>

#include "lucerna/photometry/metrics/far_field_metrics.h"
#include "lucerna/trace.h"
#include "lucerna/trace/metrics/backward_intensity.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "lucerna/trace/result/node_noise.h"
#include "tests/support/paths.h"
#include "tests/support/project_scene.h"

namespace lucerna {
namespace {

using Named = std::map<std::string, Estimate>;

/// Every figure that is determined, by name: of counted light, or with single directions of `exact`.
Named figures(const TraceResult& result, const PointIntensity& exact) {
  const std::vector<double> planes{45.0, 135.0};
  const FarFieldMetrics m = far_field_metrics(counted_far_field(result, 0), planes, exact);
  Named out{{"axis", m.axis_cd},
            {"flux 0-30", m.flux_0_30},
            {"flux 30-40", m.zonal[3]},
            {"flux 90-180", m.flux_90_180},
            {"flux code N1", m.cie_flux_code[0]},
            {"forward low", m.bug_zones[0]},
            {"uplight high", m.bug_zones[9]},
            {"glare C0 65", m.glare_cd[2]}};
  const auto add = [&](const std::string& name, const std::optional<Estimate>& e) {
    if (e) out[name] = *e;
  };
  if (m.peak) out["peak"] = m.peak->cd;
  if (m.peak) add("peak gamma", m.peak->gamma_deg);
  if (m.peak) add("peak C", m.peak->c_deg);
  add("cut-off", m.cut_off_deg);
  for (const auto& p : m.planes) {
    const std::string name = "C" + std::to_string(static_cast<int>(p.c_deg));
    add(name + " beam", p.beam_of_maximum);
    add(name + " field", p.field_of_maximum);
    add(name + " beam of centre", p.beam_of_centre);
    add(name + " field of centre", p.field_of_centre);
  }
  return out;
}

struct Coverage {
  int held = 0, runs = 0;
  double squares = 0.0;  // of gaps in stated errors
  double share() const { return static_cast<double>(held) / runs; }
};

/// How far an estimate is from the truth, in the errors of both.
double gap_in_errors(const Estimate& e, const Estimate& truth) {
  return std::abs(e.mean - truth.mean) / std::hypot(e.standard_error, truth.standard_error);
}

/// A figure that is always the same, as the flux of a mirror that catches all, has nothing to cover.
bool is_exact(const Estimate& e) { return e.standard_error <= 1e-9 * std::abs(e.mean); }

/// Root mean square of the gaps of all figures, in stated errors: 1.07 for errors that are right, of sixteen
/// draws. Below this, errors are larger than the bias of kernels makes them.
constexpr double kLeastGap = 0.35;

struct Nodes {
  Coverage within_2, within_3;
};

void count_nodes(const BinnedIntensity& test, const BinnedIntensity& truth, Nodes& nodes) {
  double peak = 0.0;
  for (const double cd : truth.distribution.cd) peak = std::max(peak, cd);
  for (std::size_t i = 0; i < test.distribution.cd.size(); ++i) {
    if (truth.distribution.cd[i] < 0.01 * peak) continue;
    const double error = std::hypot(test.standard_error_cd[i], truth.standard_error_cd[i]);
    const double gap = std::abs(test.distribution.cd[i] - truth.distribution.cd[i]);
    nodes.within_2.held += gap <= 2.0 * error ? 1 : 0;
    nodes.within_3.held += gap <= 3.0 * error ? 1 : 0;
    ++nodes.within_2.runs;
    ++nodes.within_3.runs;
  }
}

struct Runs {
  std::string scene;
  int seeds = 0;
  std::uint64_t rays = 0, truth_rays = 0;
  /// Whether light is followed backward too, as `lucerna trace` does.
  bool with_scene = false;
};

/// Coverage of many traces by a long one. Each figure's must be at least `min`, the mean of all and of the
/// nodes within the bounds.
void check(const Runs& runs, double min, double mean_min, double mean_max) {
  const auto& [scene, seeds, rays, truth_rays, with_scene] = runs;
  SCOPED_TRACE(scene);
  const Scene of_project = test::project_scene(test::source_dir() / "bench" / "figures" / (scene + ".toml"));
  const auto figures_of = [&](const TraceResult& result) {
    return figures(result, runs.with_scene ? backward_intensity(of_project, result.max_bounces, result.seed,
                                                                far_field(result, 0), no_stop())
                                           : PointIntensity());
  };
  TraceOptions options;
  options.cells = 512;
  options.seed = 987'654;
  options.last_ray = truth_rays;
  const TraceResult long_run = trace(of_project, options);
  const Named truth = figures_of(long_run);
  const BinnedIntensity truth_nodes = node_intensity(far_field(long_run, 0));
  std::map<std::string, Coverage> coverage;
  Nodes nodes;
  options.last_ray = rays;
  for (int seed = 1; seed <= seeds; ++seed) {
    options.seed = static_cast<std::uint64_t>(seed);
    const TraceResult result = trace(of_project, options);
    for (const auto& [name, e] : figures_of(result)) {
      const auto found = truth.find(name);
      if (found == truth.end() || is_exact(e)) continue;
      Coverage& c = coverage[name];
      const double gap = gap_in_errors(e, found->second);
      ++c.runs;
      c.held += gap <= kIntervalErrors ? 1 : 0;
      c.squares += gap * gap;
    }
    count_nodes(node_intensity(far_field(result, 0)), truth_nodes, nodes);
  }
  double sum = 0.0, n = 0.0, squares = 0.0;
  for (const auto& [name, c] : coverage) {
    std::cout << scene << ", " << name << ": " << 100.0 * c.share() << " % of " << c.runs << ", gaps of "
              << std::sqrt(c.squares / c.runs) << " errors\n";
    if (c.runs < seeds / 2) continue;  // determined in few runs only
    EXPECT_GE(c.share(), min) << name;
    sum += c.share();
    squares += c.squares / c.runs;
    n += 1.0;
  }
  const double gap = std::sqrt(squares / n);
  std::cout << scene << ", all figures: " << 100.0 * sum / n << " %, gaps of " << gap
            << " errors; nodes within 2 errors " << 100.0 * nodes.within_2.share() << " %, within 3 "
            << 100.0 * nodes.within_3.share() << " %\n";
  EXPECT_GE(sum / n, mean_min);
  EXPECT_LE(sum / n, mean_max);
  EXPECT_GE(nodes.within_3.share(), 0.99);
  EXPECT_GE(nodes.within_2.share(), 0.92);
  // Errors that are far too large hold the truth as well.
  EXPECT_GE(gap, kLeastGap);
  EXPECT_LE(nodes.within_2.share(), 0.96);
}

// Thirty seeds: an interval of 95 % holds in 20 or fewer with a chance of 5e-7; one that is stated at half of
// its size (67 %) would in most runs. The mean has no upper bound: the lobe is narrower than a kernel, whose
// bias is in the error of all runs alike, so that most figures hold in all of them. The gaps have a lower
// bound (0.44 of the errors at 5b6bb2a).
TEST(MetricsCoverageStatistical, IntervalsHoldTheTruth) {
  check({"parabola", 30, 1 << 17, 1 << 22}, 0.68, 0.90, 1.0);
}

// 200 seeds: 95 % holds in 169 or fewer with a chance of 1e-8, 90 % in one of two hundred. The mean over some
// twenty figures, correlated ones among them, scatters by a half to one per cent. The paraboloid's lobe is
// narrower than a kernel, as above: no upper bound.
TEST(MetricsCoverageSlow, ParaboloidHolds) { check({"parabola", 200, 1 << 18, 1 << 25}, 0.85, 0.93, 1.0); }
TEST(MetricsCoverageSlow, WideFreeFormHolds) { check({"oval", 200, 1 << 20, 1 << 26}, 0.85, 0.93, 0.97); }
TEST(MetricsCoverageSlow, BatwingHolds) { check({"batwing", 200, 1 << 18, 1 << 25}, 0.85, 0.93, 0.97); }

// The same as `lucerna trace` prints them, with peak, axis and ends by backward light. Their errors allow for
// ripples that no search saw, so that more than 95 % hold.
TEST(MetricsCoverageSlow, ParaboloidWithItsSceneHolds) {
  check({"parabola", 100, 1 << 20, 1 << 26, true}, 0.85, 0.93, 1.0);
}
TEST(MetricsCoverageSlow, WideFreeFormWithItsSceneHolds) {
  check({"oval", 100, 1 << 20, 1 << 26, true}, 0.85, 0.93, 0.98);
}
TEST(MetricsCoverageSlow, BatwingWithItsSceneHolds) {
  check({"batwing", 100, 1 << 20, 1 << 26, true}, 0.85, 0.93, 0.98);
}

// Scenes that nothing was tuned on.
TEST(MetricsCoverageSlow, EllipseWithItsSceneHolds) {
  check({"ellipse", 100, 1 << 20, 1 << 26, true}, 0.85, 0.93, 0.99);
}
TEST(MetricsCoverageSlow, FilamentHolds) {
  check({"filament", 100, 1 << 20, 1 << 26, true}, 0.85, 0.93, 0.99);
}

}  // namespace
}  // namespace lucerna
