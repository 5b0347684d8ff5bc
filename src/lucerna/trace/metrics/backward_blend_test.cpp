// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/metrics/backward_blend.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {
namespace {

/// A disk in a paraboloid that shines down on a floor, and a sensor of 8 mm there.
Scene scene() {
  Scene scene;
  EmitterOptions source;
  source.kind = EmitterKind::disk;
  scene.sources.push_back({make_emitter(source), {}, {}});
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 12.0, 0.0, Aperture::circle(90.0, 10.0));
  scene.reflectors.push_back(
      {mirror, Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 12}), Reflectance(0.9)});
  const auto plane = [&](const std::string& name, const Vec3& at_mm, double size_mm, std::size_t n) {
    PlaneDetector d;
    d.name = name;
    d.grid.world_from_plane = facing_frame(Direction::from({0, 0, 1}), {0, 1, 0}, at_mm);
    d.grid.size_x_mm = d.grid.size_y_mm = size_mm;
    d.grid.nx = d.grid.ny = n;
    scene.planes.push_back(d);
  };
  plane("sensor", {40.0, 20.0, -3000.0}, 8.0, 2);
  plane("floor", {0.0, 0.0, -3000.0}, 6000.0, 60);
  return scene;
}

TraceResult run(const Scene& scene, std::uint64_t rays, std::uint64_t seed = 1) {
  TraceOptions options;
  options.last_ray = rays;
  options.seed = seed;
  return trace(scene, options);
}

// The sensor gets some 280 of 2^18 rays. Backward light must agree with 2^23 forward rays, which know it to
// 1 %, within four errors of both; an estimate that is 6 % off is not.
TEST(BackwardBlendStatistical, SmallPlanesAreKnownBetter) {
  const Scene luminaire = scene();
  const TraceResult few = run(luminaire, 1 << 18);
  const PlaneMetrics counted = trace_metrics(few).planes[0], known = trace_metrics(few, luminaire).planes[0];
  EXPECT_LT(10.0 * known.noise, counted.noise);
  EXPECT_LT(10.0 * known.image.flux.standard_error, counted.image.flux.standard_error);
  const PlaneMetrics truth = trace_metrics(run(luminaire, 1 << 23, 7)).planes[0];
  for (const auto& [a, b] :
       {std::pair(known.extremes.mean, truth.extremes.mean), std::pair(known.image.flux, truth.image.flux)}) {
    EXPECT_NEAR(a.mean, b.mean, 4.0 * std::hypot(a.standard_error, b.standard_error));
    EXPECT_LT(std::hypot(a.standard_error, b.standard_error), 0.015 * b.mean);
  }
  const double error = std::hypot(known.extremes.max.standard_error, known.extremes.min.standard_error);
  EXPECT_LT(known.extremes.max.mean - known.extremes.min.mean, 0.06 * known.extremes.mean.mean + 4.0 * error);
}

TEST(BackwardLight, IsFollowedForWhatWantsIt) {
  Scene luminaire = scene();
  luminaire.far_fields.emplace_back();
  const TraceResult few = run(luminaire, 1 << 16);
  const TraceMetrics counted = trace_metrics(few), all = trace_metrics(few, luminaire);
  const TraceMetrics none = trace_metrics(few, luminaire, {.far_fields = false, .images = false});
  const TraceMetrics far_fields = trace_metrics(few, luminaire, {.images = false});
  const TraceMetrics images = trace_metrics(few, luminaire, {.far_fields = false});

  const auto axis = [](const TraceMetrics& m) { return m.far_fields.at(0).metrics.axis_cd.mean; };
  ASSERT_NE(axis(all), axis(counted));
  EXPECT_EQ(axis(none), axis(counted));
  EXPECT_EQ(axis(far_fields), axis(all));
  EXPECT_EQ(axis(images), axis(counted));

  const auto cells = [](const TraceMetrics& m) { return m.planes.at(0).image.value; };
  ASSERT_NE(cells(all), cells(counted));
  EXPECT_EQ(cells(none), cells(counted));
  EXPECT_EQ(cells(far_fields), cells(counted));
  EXPECT_EQ(cells(images), cells(all));
}

// A sensor that is much smaller than what one of 2^16 rays stands for.
TEST(BackwardBlendStatistical, ASensorThatNoRayFindsIsNotDark) {
  Scene luminaire = scene();
  luminaire.planes.push_back(luminaire.planes[0]);
  luminaire.planes.back().name = "wide";
  luminaire.planes[0].grid.size_x_mm = luminaire.planes[0].grid.size_y_mm = 0.1;
  const TraceResult few = run(luminaire, 1 << 16);
  ASSERT_EQ(illuminance(few, 0).flux.mean, 0.0);
  const TraceMetrics known = trace_metrics(few, luminaire);
  const Estimate small = known.planes[0].extremes.mean, wide = known.planes[2].extremes.mean;
  EXPECT_GT(small.mean, 50.0 * small.standard_error);
  EXPECT_NEAR(small.mean, wide.mean, 0.05 * wide.mean);
}

// A picture of the lit mirror, with the noise of the counted one at least halved.
TEST(BackwardBlendStatistical, LuminanceImagesAreKnownBetter) {
  Scene luminaire = scene();
  LuminanceDetector d;
  d.grid.world_from_plane = facing_frame(Direction::from({0, 0, -1}), {0, 1, 0}, {0, 0, -30});
  d.grid.size_x_mm = d.grid.size_y_mm = 90.0;
  d.grid.nx = d.grid.ny = 12;
  d.half_angle_deg = 0.5;
  luminaire.luminances.push_back(d);
  const TraceResult few = run(luminaire, 1 << 18);
  const PlaneMetrics counted = trace_metrics(few).luminances[0];
  const PlaneMetrics known = trace_metrics(few, luminaire).luminances[0];
  EXPECT_LT(2.0 * known.noise, counted.noise);
  const PlaneMetrics truth = trace_metrics(run(luminaire, 1 << 23, 7)).luminances[0];
  for (const auto& [a, b] : {std::pair(known.extremes.mean, truth.extremes.mean),
                             std::pair(known.extremes.max, truth.extremes.max)})
    EXPECT_NEAR(a.mean, b.mean, 4.0 * std::hypot(a.standard_error, b.standard_error) + 0.005 * b.mean);
}

TEST(BackwardBlend, WideFloorsStayCounted) {
  const Scene luminaire = scene();
  const TraceResult result = run(luminaire, 1 << 22);
  const PlaneImage counted = illuminance(result, 1);
  EXPECT_EQ(backward_illuminance(BackwardImage(luminaire, 100), result, 1, counted, no_stop()).weight, 0.0);
}

// A scene that is not the one that was traced: its light is dimmer by a third.
TEST(BackwardBlend, LightThatDoesNotAgreeIsNotUsed) {
  Scene luminaire = scene();
  luminaire.planes[0].grid.size_x_mm = luminaire.planes[0].grid.size_y_mm = 20.0;
  const TraceResult result = run(luminaire, 1 << 20);
  const PlaneImage counted = illuminance(result, 0);
  EXPECT_GT(backward_illuminance(BackwardImage(luminaire, 100), result, 0, counted, no_stop()).weight, 0.5);
  luminaire.reflectors[0].reflectance = Reflectance(0.6);
  EXPECT_EQ(backward_illuminance(BackwardImage(luminaire, 100), result, 0, counted, no_stop()).weight, 0.0);
}

TEST(BackwardBlend, IsTheSameForAnyThreads) {
  const Scene luminaire = scene();
  const TraceResult result = run(luminaire, 1 << 16);
  const PlaneImage counted = illuminance(result, 0);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return backward_illuminance(BackwardImage(luminaire, 100), result, 0, counted, no_stop());
  };
  const ImageBlend one = with(1), two = with(2);
  ASSERT_GT(one.weight, 0.9);
  EXPECT_EQ(one.weight, two.weight);
  EXPECT_EQ(one.values.fluxes(), two.values.fluxes());
}

}  // namespace
}  // namespace lucerna
