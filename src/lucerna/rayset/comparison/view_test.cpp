// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/ray_comparison.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

struct SourceShape {
  double radius_mm = 1.0;
  double exponent = 1.0;  // cos^n about the axis; 1 = Lambertian
  double weight_spread = 0.0;
};

/// A disk about `frame`'s origin that shines along its +z, seen on a sphere of 5 mm about that origin.
RayBlock disk_rays(std::size_t n, std::uint64_t seed, const Frame& frame, const SourceShape& shape = {}) {
  RayBlock rays;
  rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    const double r = shape.radius_mm * std::sqrt(rng.uniform()), phi = 2.0 * std::numbers::pi * rng.uniform();
    const double c = std::pow(1.0 - rng.uniform(), 1.0 / (shape.exponent + 1.0)),
                 turn = 2.0 * std::numbers::pi * rng.uniform();
    const double s = std::sqrt(1.0 - c * c);
    const Vec3 p{r * std::cos(phi), r * std::sin(phi), 0.0}, d{s * std::cos(turn), s * std::sin(turn), c};
    const double b = dot(p, d), t = -b + std::sqrt(b * b + 25.0 - dot(p, p));
    rays.set(i, frame.ray({p + t * d, Direction::from(d)}));
    rays.weight[i] = static_cast<float>(1.0 + shape.weight_spread * (rng.uniform() - 0.5));
  }
  return rays;
}

TEST(Views, FrameFollowsFromTheRays) {
  const Frame frame = Frame::from_axis(Direction::from({1, 2, -2}), 0.3, {10, -20, 5});
  const Views views(disk_rays(200'000, 1, frame));
  const ViewFrame& f = views.frame();
  EXPECT_LT(length(f.world_from_view.ez() - frame.ez()), 0.01);
  EXPECT_LT(length(f.world_from_view.origin_mm() - frame.origin_mm()), 0.02);
  EXPECT_NEAR(f.radius_mm, 5.0, 0.02);
  EXPECT_NEAR(f.near_plane_mm, 6.0, 0.02);
  // Every start is inside the paraboloid: |p| + p.z < 2 f with p.z up to 5 mm.
  EXPECT_GT(f.focal_mm, 1.25 * f.radius_mm - 1e-9);
  EXPECT_LT(f.focal_mm, 1.26 * 5.02);
}

TEST(Views, MeanDirectionOfAnIsotropicSourceIsPlusZ) {
  RayBlock rays;
  rays.resize(1000);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Rng rng(2, i);
    const double z = 2.0 * rng.uniform() - 1.0, phi = 6.28 * rng.uniform(), s = std::sqrt(1.0 - z * z);
    rays.set(i, {{}, Direction::from({s * std::cos(phi), s * std::sin(phi), z})});
    rays.weight[i] = 1.0f;
  }
  const Views views(rays);
  EXPECT_EQ(views.frame().world_from_view.ez(), (Vec3{0, 0, 1}));
  EXPECT_LT(length(views.frame().world_from_view.origin_mm()), 1e-12);
}

TEST(Views, WindowsHoldNinetyNinePercent) {
  const RayBlock rays = disk_rays(100'000, 3, {}, {.weight_spread = 1.5});
  const Views views(rays);
  ViewCounts counts(views);
  counts.add(rays);
  for (const ViewKind kind : kViewKinds) {
    const auto& w = counts.weights(kind);
    double seen = 0.0;
    for (const double x : w) seen += x;
    EXPECT_NEAR(w.back() / seen, 0.01, 2e-4) << to_string(kind);
    EXPECT_NEAR(seen, counts.total_weight(), 1e-3 * seen) << to_string(kind);
  }
  EXPECT_EQ(views.cell_count(ViewKind::far), 48u * 96 + 1);
  EXPECT_EQ(views.cell_count(ViewKind::near), 32u * 32 + 1);
  EXPECT_EQ(views.cell_count(ViewKind::focus), 64u * 64 + 1);
  EXPECT_EQ(views.cell_count(ViewKind::beam), 64u * 64 + 1);
  EXPECT_EQ(views.cell_count(ViewKind::four_d), 8u * 8 * 8 * 8 + 1);
}

TEST(Views, CollimatorTurnsRaysThroughTheFocusIntoItsAxis) {
  const Views views(disk_rays(20'000, 4, {}));
  const Vec3 focus = views.frame().world_from_view.origin_mm();
  for (std::uint64_t i = 0; i < 200; ++i) {
    Rng rng(5, i);
    const Direction d = Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, 0.2 + rng.uniform()});
    const auto x = views.coordinates(ViewKind::beam, {focus + 0.5 * d.vec(), d});
    ASSERT_TRUE(x);
    EXPECT_NEAR((*x)[0], 0.0, 1e-12);
    EXPECT_NEAR((*x)[1], 0.0, 1e-12);
  }
  // A lateral offset e at the focus tilts the beam by about e / distance to the mirror.
  const Frame& f = views.frame().world_from_view;
  const auto x = views.coordinates(ViewKind::beam, {focus + 0.01 * f.ex(), Direction::from_unit(f.ez())});
  ASSERT_TRUE(x);
  EXPECT_NEAR(std::abs((*x)[0]), 0.01 / views.frame().focal_mm, 1e-5);
}

TEST(Views, RaysThatAViewDoesNotSeeAreInNoCell) {
  const Views views(disk_rays(20'000, 6, {}));
  const Direction down = Direction::from({0.1, 0, -1}), across = Direction::from_unit({1, 0, 0});
  const Frame& f = views.frame().world_from_view;
  EXPECT_FALSE(views.cell(ViewKind::near, f.ray({{}, down})));
  EXPECT_FALSE(views.cell(ViewKind::beam, f.ray({{0, 0, 100}, Direction()})));
  EXPECT_TRUE(views.cell(ViewKind::far, f.ray({{}, across})));
}

TEST(Views, PointLineAndBeamSourcesWork) {
  RayBlock point = disk_rays(5000, 7, {}), beam = point;
  for (std::size_t i = 0; i < point.size(); ++i) {
    point.set(i, {{1, 2, 3}, point.direction(i)});
    beam.set(i, {{0.001 * static_cast<double>(i), 0, 0}, Direction()});
  }
  EXPECT_NEAR(Views(point).frame().radius_mm, 0.0, 1e-6);
  for (const RayBlock* rays : {&point, &beam}) {
    const RaySetComparison same = compare_ray_sets(*rays, *rays);
    for (const ViewKind kind : kViewKinds) EXPECT_EQ(same[kind].error, 0.0) << to_string(kind);
  }
}

TEST(Views, NoFluxIsAnError) {
  RayBlock rays;
  EXPECT_THROW(Views{rays}, InputError);
  rays = disk_rays(10, 8, {});
  for (float& w : rays.weight) w = 0.0f;
  EXPECT_THROW(Views{rays}, InputError);
  const RayBlock good = disk_rays(10, 8, {});
  EXPECT_THROW(compare_ray_sets(good, rays), InputError);
}

}  // namespace
}  // namespace lucerna
