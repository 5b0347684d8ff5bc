// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/statistics/surface_guess.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/ray_file.h"
#include "tests/support/data_dir.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

/// Rays from inside, placed where they leave `surface`; each `stray`-th starts at random instead.
RayBlock rays_on(const BoundingSurface& surface, std::size_t n, std::size_t stray) {
  RayBlock rays = test::random_ray_set(n, 11).rays;
  const Frame& frame = surface.world_from_surface;
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(3, i);
    const Vec3 inside{0.4 * rng.uniform() - 0.2, 0.4 * rng.uniform() - 0.2, 0.4 * rng.uniform() - 0.6};
    Direction d = rays.direction(i);
    if (surface.kind == SurfaceKind::plane && d.z() < 0.0) d = Direction::from_unit({d.x(), d.y(), -d.z()});
    const Ray ray{frame.point(inside), frame.direction(d)};
    const double t = i % stray == 0 ? rng.uniform() : surface.exit_distance_mm(ray).value();
    rays.set(i, {ray.at(std::min(t, 50.0)), ray.direction});
  }
  return rays;
}

const Frame kTilted = Frame::from_axis(Direction::from({1, 2, -3}), 0.7, {5, -7, 30});

TEST(SurfaceGuess, FindsEveryKindInAnyPlaceThroughStrayRays) {
  for (const Frame& placed : {Frame{}, kTilted}) {
    for (const BoundingSurface& plain :
         {BoundingSurface::plane(0.5), BoundingSurface::sphere(10.0), BoundingSurface::cylinder(2.0, 9.0),
          BoundingSurface::box({2.0, 3.0, 5.0})}) {
      BoundingSurface truth = plain;
      truth.world_from_surface = placed * plain.world_from_surface;
      const SurfaceGuess guess = guess_surface(rays_on(truth, 20000, 25));
      ASSERT_EQ(guess.shape, StartShape::surface) << to_string(plain.kind);
      EXPECT_EQ(guess.surface.kind, plain.kind) << describe(guess);
      EXPECT_NEAR(guess.share, 0.96, 0.02);
      EXPECT_NEAR(guess.surface.radius_mm, plain.radius_mm, 0.01);
      if (plain.kind == SurfaceKind::cylinder) {
        EXPECT_NEAR(guess.surface.half_size_mm.z, 4.5, 0.02);
      }
      if (plain.kind == SurfaceKind::box) {
        std::array<double, 3> edges{guess.surface.half_size_mm.x, guess.surface.half_size_mm.y,
                                    guess.surface.half_size_mm.z};
        std::ranges::sort(edges);
        EXPECT_THAT(edges,
                    ::testing::ElementsAre(::testing::DoubleNear(1.0, 0.01), ::testing::DoubleNear(1.5, 0.01),
                                           ::testing::DoubleNear(2.5, 0.01)));
      }
      if (plain.kind == SurfaceKind::plane) {
        EXPECT_GT(dot(guess.surface.world_from_surface.ez(), truth.world_from_surface.ez()), 1.0 - 1e-6)
            << "towards the light";
      }
    }
  }
}

TEST(SurfaceGuess, APlaneIsNoHugeSphere) {
  RayBlock rays = test::random_ray_set(20000, 11).rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Rng rng(3, i);
    const Vec3 p{3.0 * rng.uniform(), 2.0 * rng.uniform(), 0.0};
    rays.set(i, {kTilted.point(p), kTilted.direction({})});
  }
  for (const double min_share : {0.9, 0.999}) {
    const SurfaceGuess guess = guess_surface(rays, min_share);
    EXPECT_EQ(guess.surface.kind, SurfaceKind::plane) << describe(guess);
    EXPECT_GT(guess.share, 0.999);
  }
}

TEST(SurfaceGuess, PointsLinesAndVolumes) {
  RayBlock rays = test::random_ray_set(3000, 5).rays;
  EXPECT_EQ(guess_surface(rays).shape, StartShape::scattered);
  EXPECT_EQ(guess_surface(rays).surface.kind, SurfaceKind::none);
  const RayBlock all = rays;
  for (std::size_t i = 0; i < rays.size(); ++i)
    rays.set(i, {kTilted.point({0, 0, 0.001 * static_cast<double>(i)}), all.direction(i)});
  const SurfaceGuess line = guess_surface(rays);
  EXPECT_EQ(line.shape, StartShape::line);
  EXPECT_NEAR(std::abs(dot(line.line.vec(), kTilted.ez())), 1.0, 1e-6);
  for (std::size_t i = 0; i < rays.size(); ++i) rays.set(i, {{1, 2, 3}, all.direction(i)});
  EXPECT_EQ(guess_surface(rays).shape, StartShape::point);
  EXPECT_EQ(guess_surface(rays).point_mm, (Vec3{1, 2, 3}));
  rays.weight.assign(rays.size(), 0.0F);
  EXPECT_EQ(guess_surface(rays).shape, StartShape::point) << "dark rays start somewhere too";
  EXPECT_EQ(guess_surface(RayBlock{}).shape, StartShape::scattered);
  rays.resize(1);
  EXPECT_EQ(guess_surface(rays).shape, StartShape::point);
}

TEST(SurfaceGuessData, RealFiles) {
  LUCERNA_DATA_FILE(led, "rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY");
  const SurfaceGuess plane = guess_surface(read_ray_set(led).rays);
  EXPECT_EQ(plane.surface.kind, SurfaceKind::plane) << describe(plane);
  EXPECT_NEAR(plane.share, 0.982, 0.01);
  EXPECT_NEAR(plane.surface.world_from_surface.origin_mm().z, 0.02, 1e-5);
  LUCERNA_DATA_FILE(lighttools, "rayfiles/Cyl10k.1.tm25ray");
  const SurfaceGuess sphere = guess_surface(read_ray_set(lighttools).rays);
  EXPECT_EQ(sphere.surface.kind, SurfaceKind::sphere) << describe(sphere);
  EXPECT_NEAR(sphere.surface.radius_mm, 10.0, 1e-3);
  EXPECT_NEAR(sphere.surface.world_from_surface.origin_mm().z, 10.0, 1e-3);
  LUCERNA_DATA_FILE(point, "rayfiles/farfield.TM25ray");
  EXPECT_EQ(guess_surface(read_ray_set(point).rays).shape, StartShape::point);
}

}  // namespace
}  // namespace lucerna
