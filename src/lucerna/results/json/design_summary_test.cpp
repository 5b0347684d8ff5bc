// SPDX-License-Identifier: Apache-2.0
// What `lucerna design` prints of figures that are wide or not determined.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/results/json/design_json.h"
#include "tests/support/temp_dir.h"
#include "tests/support/text_scan.h"

namespace lucerna {
namespace {

constexpr const char* kLamp = R"([[source]]
kind = "disk"
[[reflector]]
family = "bspline"
focal_mm = 15
diameter_mm = 60
position_mm = [0, 0, 15]
axis = "-z"
[target]
file = "target.ldt"
)";

/// The lines of a design of kLamp whose light has its peak far off the axis, with these tolerances.
std::vector<std::string> summary_with(const std::vector<ToleranceSpread>& spread) {
  const test::TempDir dir;
  write_file(dir / "start.toml", "[[source]]\nkind = \"disk\"\naxis = \"-z\"\n");
  write_file(dir / "lamp.toml", kLamp);
  TraceOptions options;
  options.last_ray = 1 << 14;
  DesignMetrics metrics;
  metrics.trace = trace_metrics(trace(read_project(dir / "start.toml").scene, options));
  const IntensityDistribution light = metrics.trace.far_fields.front().intensity.distribution;
  write_photometric_file(dir / "target.ldt", {.distribution = light, .luminaire = {}},
                         PhotometricFormat::ldt);
  metrics.target_beam = beam_metrics(light);
  const DesignProblem problem = design_problem(read_project(dir / "lamp.toml"), dir / "lamp.toml");
  PeakEstimate& peak = metrics.trace.far_fields.front().metrics.peak.value();
  peak.c_deg = {145.7, 1.9};
  peak.gamma_deg = {63.0, 0.7};
  peak.direction = direction_from_type_c({.c_rad = 2.543, .gamma_rad = 1.0996});
  metrics.tolerances = ToleranceSweep{};
  metrics.tolerances->spread = spread;
  const DesignResult result(problem.start);
  return design_summary(problem.target, result, design_form(result), metrics);
}

const std::string& line_of(const std::vector<std::string>& lines, std::string_view start) {
  const auto found = std::ranges::find_if(lines, [&](const std::string& l) { return l.starts_with(start); });
  return found == lines.end() ? lines.front() : *found;
}

TEST(DesignSummary, KeepsColumnsApartAndNamesWhatIsNotDetermined) {
  const Estimate unknown{std::nan(""), std::nan("")};
  const auto lines = summary_with({{"beam_c0_deg", unknown, unknown, unknown, unknown, unknown},
                                   {"centre", {233, 11}, {230, 11}, {12.3, 1.6}, {210, 20}, {250, 30}, 16}});
  EXPECT_TRUE(test::has(line_of(lines, "  peak at"), " deg  ")) << line_of(lines, "  peak at");
  const std::string& beam = line_of(lines, "  beam_c0_deg");
  EXPECT_FALSE(test::has(beam, "nan")) << beam;
  EXPECT_EQ(test::between(beam + " ", "not ", " ").size(), 3u) << beam;
  EXPECT_TRUE(beam.ends_with(" -  (determined in 0 of 16 cases)")) << beam;
  EXPECT_TRUE(test::has(line_of(lines, "  centre  "), "233 +- 11")) << line_of(lines, "  centre  ");
  EXPECT_TRUE(line_of(lines, "  centre  ").ends_with("12.3 +- 1.6"));
}

}  // namespace
}  // namespace lucerna
