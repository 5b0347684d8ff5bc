// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/metrics/trace_warnings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/core/io/file.h"
#include "lucerna/trace.h"
#include "tests/support/project_scene.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// A far field of steps 5 and 1 whose exact peak, half as high two degrees away, is on the axis.
FarFieldResult beam(double peak_cd, double largest_cd) {
  FarFieldResult f;
  f.field.name = "far";
  f.field.c_step_deg = 5.0;
  f.field.gamma_step_deg = 1.0;
  f.field.c_count = 72;
  f.field.gamma_count = 181;
  f.intensity.distribution.cd = {largest_cd, 0.1 * largest_cd};
  f.intensity.standard_error_cd = {0.001 * largest_cd, 0.0};
  PeakEstimate peak;
  peak.cd = {peak_cd, 0.001 * peak_cd};
  peak.half_width_deg = 1.2;
  f.metrics.peak = peak;
  return f;
}

std::vector<std::string> warnings_of(FarFieldResult f) {
  TraceMetrics figures;
  figures.far_fields.push_back(std::move(f));
  return trace_warnings(figures);
}

TEST(TraceWarnings, AGridThatIsTooCoarseForThePeakIsNamed) {
  EXPECT_THAT(
      warnings_of(beam(81300.0, 66152.0)),
      ElementsAre("far: its files are on a grid that is too coarse for the beam: their largest value is "
                  "66152 cd, the peak is 81300 +- 80 cd; a finer grid: gamma_step_deg = 0.25 (now 1) "
                  "of the detector"));
  FarFieldResult aside = beam(81300.0, 66152.0);
  aside.metrics.peak->direction = direction_from_type_c({0.0, radians(30.0)});
  EXPECT_THAT(
      warnings_of(aside),
      ElementsAre(HasSubstr("gamma_step_deg = 0.25 (now 1), c_step_deg = 0.5 (now 5) of the detector")));
}

TEST(TraceWarnings, WhatIsNoFaultOfTheGridIsNone) {
  EXPECT_THAT(warnings_of(beam(81300.0, 79000.0)), IsEmpty()) << "within 5 %";
  EXPECT_THAT(warnings_of(beam(66152.0, 81300.0)), IsEmpty()) << "noise can only be above";
  FarFieldResult noisy = beam(81300.0, 66152.0);
  noisy.intensity.standard_error_cd[0] = 5000.0;
  EXPECT_THAT(warnings_of(noisy), IsEmpty());
  FarFieldResult wide = beam(81300.0, 66152.0);
  wide.metrics.peak->half_width_deg = 40.0;
  EXPECT_THAT(warnings_of(wide), IsEmpty()) << "no finer grid would bring it nearer";
  FarFieldResult dark = beam(0.0, 0.0);
  dark.metrics.peak.reset();
  EXPECT_THAT(warnings_of(dark), IsEmpty());
}

TEST(TraceWarnings, CountedLightInCellsThatAreWideForTheLobeIsNamed) {
  FarFieldResult counted = beam(81300.0, 66152.0);
  counted.metrics.peak->radius_deg = 1.0;
  EXPECT_THAT(
      warnings_of(counted),
      ElementsAre(HasSubstr("far: peak, axis and angles are of light counted in cells of 1 deg, which are "
                            "wide for a lobe whose half width is 1.2 deg")));
  counted.metrics.peak->half_width_deg = 3.5;
  EXPECT_THAT(warnings_of(counted), IsEmpty());
}

constexpr const char* kSpot = R"([[source]]
kind = "disk"
radius_mm = 1.0
AXIS
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 15.0
diameter_mm = 59.0
position_mm = [0, 0, 15]
axis = "-z"
[[detector]]
name = "far"
kind = "far-field"
gamma_step_deg = STEP
)";

std::vector<std::string> traced(const std::string& axis, const std::string& step) {
  std::string text = kSpot;
  text.replace(text.find("AXIS"), 4, axis);
  text.replace(text.find("STEP"), 4, step);
  const test::TempDir dir;
  write_file(dir / "p.toml", text);
  const Scene scene = test::project_scene(dir / "p.toml");
  return trace_warnings(trace_metrics(trace(scene, {.last_ray = 1 << 18}), scene), scene);
}

// A beam of 4 degrees: its top of a degree is lost in cells of 5, not in those of 0.2.
TEST(TraceWarnings, ANarrowBeamNeedsAFineGrid) {
  EXPECT_THAT(traced("", "5.0"), ElementsAre(HasSubstr("gamma_step_deg = ")));
  EXPECT_THAT(traced("", "0.2"), IsEmpty());
}

TEST(TraceWarnings, ASourceThatFacesAwayIsNamed) {
  EXPECT_THAT(
      traced("axis = \"-z\"", "1.0"),
      ElementsAre("no light reaches a mirror: of 262144 rays none is reflected; check position_mm and "
                  "axis of source and reflector"));
}

TEST(TraceWarnings, TooFewRaysForAnyErrorAreTold) {
  TraceMetrics figures;
  figures.ledger.rays = 100;
  figures.ledger.out_direct = {1.0, std::nan("")};
  EXPECT_THAT(trace_warnings(figures, Scene(), {}),
              ElementsAre("100 rays are too few for any error: the figures stand without"));
}

TEST(TraceWarnings, ThoseOfTheProjectComeFirst) {
  TraceMetrics figures;
  figures.far_fields.push_back(beam(81300.0, 66152.0));
  const std::vector<std::string> found = trace_warnings(figures, Scene(), {"lamp.toml: odd"});
  EXPECT_THAT(found, ElementsAre("lamp.toml: odd", HasSubstr("too coarse")));
}

}  // namespace
}  // namespace lucerna
