// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/tolerances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/progress.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

/// A small disk in the focus of a paraboloid that shines down.
Scene spot() {
  EmitterOptions emitter;
  emitter.kind = EmitterKind::disk;
  emitter.radius_mm = 0.1;
  Scene scene;
  scene.sources.push_back({make_emitter(emitter), Frame(), {}});
  PlacedReflector mirror;
  mirror.reflector = conic_reflector(ConicPreset::parabola, 10.0, 0.0, Aperture::circle(60));
  mirror.world_from_reflector = Frame::from_axis(Direction::from(Vec3{0, 0, -1}), 0.0, {0, 0, 10});
  mirror.reflectance = Reflectance(0.85);
  scene.reflectors.push_back(mirror);
  scene.far_fields.emplace_back();
  return scene;
}

const ToleranceMetrics& figures(const ToleranceSweep& sweep, const std::string& name) {
  const auto found = std::find_if(sweep.cases.begin(), sweep.cases.end(),
                                  [&](const ToleranceCase& c) { return c.name == name; });
  return sweep.figures.at(static_cast<std::size_t>(found - sweep.cases.begin()));
}

TEST(Tolerances, TheSweepSeesWhatOpticsSays) {
  ToleranceRanges ranges;
  ranges.source_shift_mm = 0.3;
  ranges.slope_error_mrad = 8.0;
  ranges.samples = 4;
  ranges.rays = 1 << 17;
  const ToleranceSweep sweep = tolerance_sweep(spot(), ranges, 3);
  const ToleranceMetrics& nominal = sweep.figures.front();
  EXPECT_EQ(sweep.cases.front().name, "nominal");
  // On the axis all of the mirror that the disk's face lights shows its luminance. The beam is half a degree
  // wide, so that cells of one degree alone have two thirds of it, with a tenth of it as their error.
  const double truth_cd = 0.85 * 1000.0 * 20.0 * 20.0 / (std::numbers::pi * 0.1 * 0.1);
  EXPECT_NEAR(nominal.centre.mean, truth_cd, 3.0 * nominal.centre.standard_error);
  EXPECT_LT(nominal.centre.standard_error, 0.01 * truth_cd);
  EXPECT_NEAR(nominal.peak.mean, truth_cd, 3.0 * nominal.peak.standard_error + 0.005 * truth_cd);
  // The disk looks at the mirror: every ray is reflected once, so efficiency follows the reflectance.
  EXPECT_NEAR(nominal.efficiency.mean, 0.85, 0.01);
  EXPECT_NEAR(figures(sweep, "reflectance+").efficiency.mean - nominal.efficiency.mean, 0.02, 2e-3);
  EXPECT_NEAR(figures(sweep, "reflectance-").efficiency.mean - nominal.efficiency.mean, -0.02, 2e-3);
  // Slope errors blur, a shift along the axis defocuses: the peak falls. A shift aside leaves the flux.
  EXPECT_LT(figures(sweep, "slope_error+").peak.mean, 0.9 * nominal.peak.mean);
  EXPECT_LT(figures(sweep, "shift_z+").peak.mean, nominal.peak.mean);
  EXPECT_NEAR(figures(sweep, "shift_x+").efficiency.mean, nominal.efficiency.mean, 0.01);
  // The spot is round: shifts along x and y do the same.
  EXPECT_NEAR(figures(sweep, "shift_x+").centre.mean, figures(sweep, "shift_y+").centre.mean,
              0.05 * nominal.centre.mean);
  for (const ToleranceSpread& s : sweep.spread) {
    EXPECT_LE(s.min.mean, s.mean.mean + 1e-12) << s.figure;
    EXPECT_GE(s.max.mean, s.mean.mean - 1e-12) << s.figure;
  }
  EXPECT_EQ(sweep.spread[0].figure, "efficiency");
  const Estimate& deviation = sweep.spread[0].standard_deviation;
  EXPECT_GT(deviation.mean, 0.0);
  EXPECT_NEAR(deviation.standard_error, deviation.mean / std::sqrt(6.0), 1e-12) << "of four cases";
  const std::string csv = tolerances_csv(sweep);
  EXPECT_EQ(static_cast<std::size_t>(std::count(csv.begin(), csv.end(), '\n')), sweep.cases.size() + 1);
}

/// Counts the cases that are traced.
class CountCases final : public Progress {
 public:
  void update(std::string_view, std::uint64_t, std::uint64_t total) override { cases = total; }
  bool stop_requested() const override { return false; }
  std::uint64_t cases = 0;
};

TEST(Tolerances, WhatChangesNothingIsTheDesignItself) {
  ToleranceRanges ranges{0.0, 0.0, 0.0, 0.05, 2, 1 << 15};
  CountCases traced;
  const ToleranceSweep sweep = tolerance_sweep(spot(), ranges, 3, traced);
  ASSERT_EQ(sweep.cases.size(), 16u);
  EXPECT_EQ(traced.cases, 5u) << "the design, two of reflectance, two combined";
  const ToleranceMetrics& nominal = sweep.figures.front();
  EXPECT_GT(nominal.peak.standard_error, 0.0);
  for (std::size_t i = 1; i < sweep.cases.size(); ++i) {
    const bool same = sweep.cases[i].reflectance == 0.0;
    EXPECT_EQ(sweep.figures[i].efficiency.mean == nominal.efficiency.mean, same) << sweep.cases[i].name;
    EXPECT_EQ(sweep.figures[i].peak.mean == nominal.peak.mean, same) << sweep.cases[i].name;
    // With the same rays the light goes with the reflectance.
    EXPECT_NEAR(sweep.figures[i].centre.mean / nominal.centre.mean, 1.0 + sweep.cases[i].reflectance / 0.85,
                1e-9);
  }
}

TEST(Tolerances, SourcesMoveAsOneBody) {
  Scene scene = spot();
  scene.sources.push_back(scene.sources.front());
  scene.sources[0].world_from_source = Frame::from_axis(Direction(), 0.0, {-2, 0, 0});
  scene.sources[1].world_from_source = Frame::from_axis(Direction(), 0.0, {2, 0, 0});
  ToleranceCase c{"", {0.5, 0, 0}};
  c.tilt_y_deg = 90.0;
  const Scene moved = changed(scene, c);
  const Vec3 a = moved.sources[0].world_from_source.origin_mm(),
             b = moved.sources[1].world_from_source.origin_mm();
  EXPECT_NEAR(length(a - Vec3{0.5, 0, 2}), 0.0, 1e-12);
  EXPECT_NEAR(length(b - Vec3{0.5, 0, -2}), 0.0, 1e-12);
}

}  // namespace
}  // namespace lucerna
