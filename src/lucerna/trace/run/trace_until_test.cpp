// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/result/node_noise.h"

namespace lucerna {
namespace {

Scene spot() {
  Scene scene;
  scene.sources.push_back({make_emitter({.kind = EmitterKind::cylinder, .radius_mm = 1.0, .length_mm = 6.0}),
                           Frame(), std::nullopt});
  scene.reflectors.push_back({conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0)),
                              Frame::from_axis(-Direction(), 0.0, {0, 0, 15}), Reflectance(0.9)});
  scene.far_fields = {{"far", 15.0, 2.5}};
  return scene;
}

TraceOptions coarse() {
  TraceOptions options;
  options.cells = 256;
  return options;
}

TEST(TraceUntil, TracesUntilTheNoiseIsWhatWasAskedFor) {
  Scene lamp = spot();  // whose flat peak is known long before the nodes are
  lamp.reflectors.clear();
  const double first = node_noise(trace(lamp, [] {
    TraceOptions o = coarse();
    o.last_ray = 1 << 20;
    return o;
  }()));
  ASSERT_GT(first, 0.0);
  ASSERT_LT(first, 0.1);
  const NoiseTrace loose = trace_until(lamp, coarse(), {.noise = 0.5, .max_seconds = 1e6});
  EXPECT_EQ(loose.result.last_ray, 1u << 20);
  EXPECT_EQ(loose.end, NoiseEnd::reached);
  const NoiseTrace fine = trace_until(lamp, coarse(), {.noise = 0.7 * first, .max_seconds = 1e6});
  EXPECT_EQ(fine.end, NoiseEnd::reached);
  EXPECT_GT(fine.result.last_ray, 1u << 20);
  EXPECT_LE(fine.noise, 0.7 * first);
  EXPECT_EQ(fine.noise, node_noise(fine.result));
}

TEST(TraceUntil, SameBitsForAnyThreadsAndAfterAStop) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    return trace_until(spot(), coarse(), {.noise = 1e-9, .max_rays = 3 << 19});
  };
  const NoiseTrace one = run(1), two = run(2);
  EXPECT_EQ(one.end, NoiseEnd::rays);
  EXPECT_EQ(one.result.last_ray, 3u << 19);
  EXPECT_EQ(one.result.replicates, two.result.replicates);
  // Stopped in the middle of a round, and gone on with.
  const NoiseTrace part = trace_until(spot(), coarse(), {.noise = 1e-9, .max_rays = 1'234'567});
  EXPECT_EQ(part.result.last_ray, 1'234'567u);
  const NoiseTrace rest = trace_until(spot(), coarse(), {.noise = 1e-9, .max_rays = 3 << 19}, part.result);
  EXPECT_EQ(rest.result.replicates, one.result.replicates);
  EXPECT_EQ(rest.result.last_ray, one.result.last_ray);
}

TEST(TraceUntil, TimeOnlyStops) {
  const NoiseTrace stopped = trace_until(spot(), coarse(), {.noise = 1e-9, .max_seconds = 0.0});
  EXPECT_EQ(stopped.end, NoiseEnd::time);
  EXPECT_GE(stopped.result.last_ray, 1u << 20);
  EXPECT_GT(stopped.noise, 1e-9);
}

TEST(TraceUntil, WithoutAFarFieldItTracesAsBefore) {
  Scene scene = spot();
  scene.far_fields.clear();
  PlaneDetector plane;
  plane.grid = {Frame::from_axis(-Direction(), 0.0, {0, 0, -100}), 100.0, 100.0, 4, 4};
  scene.planes = {plane};
  const NoiseTrace traced = trace_until(scene, coarse(), {});
  EXPECT_EQ(traced.end, NoiseEnd::no_goal);
  EXPECT_EQ(traced.result.last_ray, default_ray_count(scene));
  EXPECT_TRUE(std::isnan(traced.noise));
}

}  // namespace
}  // namespace lucerna
