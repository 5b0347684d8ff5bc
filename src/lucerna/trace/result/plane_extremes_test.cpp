// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/result/plane_extremes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/source.h"
#include "lucerna/trace.h"

namespace lucerna {
namespace {

/// A small disk 100 mm above a plane of 40 mm: illuminance falls from the middle as cos^4.
Scene lit_plane() {
  Scene scene;
  EmitterOptions disk;
  disk.kind = EmitterKind::disk;
  disk.radius_mm = 0.01;
  scene.sources.push_back({make_emitter(disk), {}, {}});
  PlaneDetector plane;
  plane.name = "wall";
  plane.grid = {Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, 100}), 40.0, 40.0, 20, 20};
  scene.planes.push_back(plane);
  return scene;
}

PlaneExtremes seen(std::uint64_t seed, PlaneImage* image) {
  TraceOptions options;
  options.last_ray = 1 << 18;
  options.seed = seed;
  options.sequence = SequenceKind::random;
  const TraceResult result = trace(lit_plane(), options);
  *image = illuminance(result, 0);
  return illuminance_extremes(result, 0, {*image, {}, *image});
}

// The largest of 400 cells of which each has 40 rays is far too large; what is stated is not. Means of twelve
// runs: a false alarm at five of their standard errors is one in a million.
TEST(PlaneExtremesStatistical, ArePulledNeitherUpNorDownByNoise) {
  const double peak = 1000.0 / std::numbers::pi / (0.1 * 0.1);  // lx: cd / m^2 of distance squared
  const double corner = peak * std::pow(1.0 / (1.0 + 2 * 0.19 * 0.19), 2.0);
  double plain = 0.0, max = 0.0, min = 0.0, error = 0.0;
  constexpr int kRuns = 12;
  for (int run = 1; run <= kRuns; ++run) {
    PlaneImage image;
    const PlaneExtremes e = seen(static_cast<std::uint64_t>(run), &image);
    plain += *std::max_element(image.value.begin(), image.value.end()) / kRuns;
    max += e.max.mean / kRuns;
    min += e.min.mean / kRuns;
    error = std::max(error, e.max.standard_error);
    EXPECT_NEAR(e.mean.mean, peak * 0.949, 0.05 * peak);
    ASSERT_TRUE(e.uniformity.has_value());
    EXPECT_NEAR(e.uniformity->mean, e.min.mean / e.mean.mean, 0.05);
    EXPECT_GT(e.uniformity->standard_error, 0.0);
  }
  EXPECT_GT(plain, 1.25 * peak);
  EXPECT_LT(max, peak + 0.6 * (plain - peak));
  EXPECT_NEAR(max, peak, 2.0 * error);
  EXPECT_LT(min, corner);
  EXPECT_GT(min, 0.5 * corner);
}

TEST(PlaneExtremes, OfADarkPlaneAreZero) {
  Scene scene = lit_plane();
  scene.planes[0].grid.world_from_plane = Frame::from_axis(Direction::from({0, 0, 1}), 0.0, {0, 0, -100});
  TraceOptions options;
  options.last_ray = 4096;
  const TraceResult result = trace(scene, options);
  const PlaneImage image = illuminance(result, 0);
  const PlaneExtremes e = illuminance_extremes(result, 0, {image, {}, image});
  EXPECT_EQ(e.max.mean, 0.0);
  EXPECT_EQ(e.min.mean, 0.0);
  EXPECT_EQ(e.mean.mean, 0.0);
  EXPECT_FALSE(e.uniformity.has_value());
}

}  // namespace
}  // namespace lucerna
