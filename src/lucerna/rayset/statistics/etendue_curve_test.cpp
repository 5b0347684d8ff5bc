// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/statistics/etendue_curve.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lucerna/geometry.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

/// A Lambertian disk of radius 1 mm: étendue pi^2 mm^2 sr, the same luminance everywhere.
RayBlock disk_rays(std::size_t n, const Frame& placed) {
  RayBlock rays;
  rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(5, i);
    const double r = std::sqrt(rng.uniform()), a = 2.0 * std::numbers::pi * rng.uniform();
    const double s = std::sqrt(rng.uniform()), b = 2.0 * std::numbers::pi * rng.uniform();
    const Direction d =
        Direction::from_unit({s * std::cos(b), s * std::sin(b), std::sqrt(std::max(0.0, 1.0 - s * s))});
    rays.set(i, placed.ray({{r * std::cos(a), r * std::sin(a), 0.0}, d}));
    rays.weight[i] = 1.0F;
  }
  return rays;
}

constexpr double kDisk = std::numbers::pi * std::numbers::pi;

TEST(EtendueCurve, LambertianDiskOfAnyTilt) {
  for (const Frame& placed : {Frame{}, Frame::from_axis(Direction::from({1, 2, -3}), 0.7, {5, -7, 30})}) {
    const EtendueCurve curve = etendue_curve(disk_rays(100000, placed));
    EXPECT_NEAR(curve.at(0.5), 0.5 * kDisk, 0.05 * 0.5 * kDisk);
    EXPECT_NEAR(curve.at(0.9), 0.9 * kDisk, 0.10 * 0.9 * kDisk);
    EXPECT_LT(curve.at(0.5), curve.at(0.9));
    EXPECT_EQ(curve.at(0.0), 0.0);
  }
}

TEST(EtendueCurve, ABrightSpotComesFirst) {
  RayBlock rays = disk_rays(60000, {});
  for (std::size_t i = 0; i < 30000; ++i) rays.x_mm[i] *= 0.25F, rays.y_mm[i] *= 0.25F;
  const EtendueCurve curve = etendue_curve(rays);
  EXPECT_NEAR(curve.at(0.45), 0.45 / (0.5 + 0.5 / 16.0) * kDisk / 16.0, 0.15 * kDisk / 16.0);
  EXPECT_GT(curve.at(0.9), 0.5 * kDisk);
}

TEST(EtendueCurve, PointsBeamsAndNothing) {
  RayBlock rays = disk_rays(1000, {});
  RayBlock beam = rays;
  rays.x_mm.assign(1000, 1.0F), rays.y_mm.assign(1000, 1.0F), rays.z_mm.assign(1000, 1.0F);
  EXPECT_LT(etendue_curve(rays).at(0.9), 1e-6);
  beam.kx.assign(1000, 0.0F), beam.ky.assign(1000, 0.0F), beam.kz.assign(1000, 1.0F);
  EXPECT_LT(etendue_curve(beam).at(0.9), 1e-6);
  EXPECT_TRUE(etendue_curve(RayBlock{}).degenerate());
  EXPECT_EQ(etendue_curve(RayBlock{}).at(0.5), 0.0);
}

}  // namespace
}  // namespace lucerna
