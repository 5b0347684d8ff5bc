// SPDX-License-Identifier: Apache-2.0
#include "lucerna/bounding_surface.h"

#include <gtest/gtest.h>

#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

std::vector<BoundingSurface> bodies() {
  std::vector<BoundingSurface> all{BoundingSurface::sphere(3.0), BoundingSurface::cylinder(2.0, 5.0),
                                   BoundingSurface::box({2.0, 3.0, 4.0}), BoundingSurface::plane(2.5)};
  const std::size_t n = all.size();
  for (std::size_t i = 0; i < n; ++i) {
    all.push_back(all[i]);
    all.back().world_from_surface =
        Frame::from_axis(Direction::from({1, 2, -1}), 0.7, {5, -3, 1}) * all[i].world_from_surface;
  }
  return all;
}

Vec3 random_vector(Rng& rng) { return {rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5}; }

TEST(BoundingSurface, ExitLiesOnTheSurfaceAndTheRayGoesOutward) {
  Rng rng(1, 0);
  for (const BoundingSurface& surface : bodies()) {
    int hits = 0;
    for (int i = 0; i < 2000; ++i) {
      const Ray ray{surface.world_from_surface.point(10.0 * random_vector(rng)),
                    Direction::from(random_vector(rng))};
      const auto t = surface.exit_distance_mm(ray);
      if (!t) continue;
      ++hits;
      EXPECT_NEAR(surface.outside_mm(ray.at(*t)), 0.0, 1e-14 * (100.0 + std::abs(*t)));
      EXPECT_GT(surface.outside_mm(ray.at(*t + 1e-3)), 0.0);
      EXPECT_LE(surface.outside_mm(ray.at(*t - 1e-7)), 1e-9);
    }
    EXPECT_GT(hits, 100) << to_string(surface.kind);
  }
}

TEST(BoundingSurface, RaysFromInsideAlwaysLeaveForward) {
  Rng rng(2, 0);
  for (const BoundingSurface& surface : bodies()) {
    if (surface.kind == SurfaceKind::plane) continue;
    for (int i = 0; i < 1000; ++i) {
      const Ray ray{surface.world_from_surface.point(1.9 * random_vector(rng)),
                    Direction::from(random_vector(rng))};
      ASSERT_LT(surface.outside_mm(ray.origin_mm), 0.0);
      const auto t = surface.exit_distance_mm(ray);
      ASSERT_TRUE(t.has_value());
      EXPECT_GT(*t, 0.0);
    }
  }
}

TEST(BoundingSurface, ParallelLinesAreSettledBySide) {
  const auto box = BoundingSurface::box({2, 2, 2});
  EXPECT_EQ(box.exit_distance_mm({{0.5, 0, 0}, Direction::from({0, 0, 1})}), 1.0);
  EXPECT_FALSE(box.exit_distance_mm({{1.5, 0, 0}, Direction::from({0, 0, 1})}).has_value());
  const auto cylinder = BoundingSurface::cylinder(1, 4);
  EXPECT_EQ(cylinder.exit_distance_mm({{0.5, 0, 0}, Direction::from({0, 0, -1})}), 2.0);
  EXPECT_FALSE(cylinder.exit_distance_mm({{1.5, 0, 0}, Direction::from({0, 0, 1})}).has_value());
  EXPECT_FALSE(
      BoundingSurface::plane(0).exit_distance_mm({{0, 0, -1}, Direction::from({1, 0, 0})}).has_value());
  EXPECT_FALSE(BoundingSurface{}.exit_distance_mm({}).has_value());
}

TEST(BoundingSurface, SizesAreCountedAndChecked) {
  EXPECT_EQ(BoundingSurface::from_sizes(SurfaceKind::cylinder, std::vector{2.0, 6.0}).half_size_mm.z, 3.0);
  EXPECT_EQ(BoundingSurface::from_sizes(SurfaceKind::plane, std::vector{-1.0}).outside_mm({0, 0, 0}), 1.0);
  EXPECT_THROW(BoundingSurface::from_sizes(SurfaceKind::sphere, std::vector{1.0, 2.0}), InputError);
  EXPECT_THROW(BoundingSurface::from_sizes(SurfaceKind::box, std::vector{1.0, 0.0, 2.0}), InputError);
}

TEST(BoundingSurface, NamesRoundTrip) {
  for (const char* name : {"none", "plane", "sphere", "cylinder", "box"})
    EXPECT_EQ(to_string(surface_kind(name)), name);
  EXPECT_THROW(surface_kind("egg"), UsageError);
}

}  // namespace
}  // namespace lucerna
