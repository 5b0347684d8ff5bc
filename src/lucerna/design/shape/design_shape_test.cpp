// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/shape/design_shape.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

DesignShape with_random(const DesignShape& shape, std::uint64_t seed) {
  Eigen::VectorXd p = shape.parameters();
  Rng rng(seed, 0);
  for (double& x : p) x = rng.uniform();
  return shape.with(p);
}

/// The largest difference of height and slope between two shapes over the aperture.
double difference(const DesignShape& a, const DesignShape& b) {
  double max = 0.0;
  for (double x = -24.9; x < 25.0; x += 1.7) {
    for (double y = -24.9; y < 25.0; y += 1.9) {
      if (!a.aperture().contains(x, y)) continue;
      const SurfacePoint p = a.at(x, y), q = b.at(x, y);
      max = std::max({max, std::abs(p.z_mm - q.z_mm), std::abs(p.dzdx - q.dzdx), std::abs(p.dzdy - q.dzdy)});
    }
  }
  return max;
}

TEST(DesignShape, DoublingTheKnotsKeepsTheSurface) {
  const Aperture round = Aperture::circle(50), square = Aperture::rectangle(50, 50);
  const DesignShape a = with_random(DesignShape::revolution(10, round, 5), 1);
  EXPECT_LT(difference(a, a.refined(10, 0)), 1e-11);
  EXPECT_LT(difference(a, a.refined(15, 0)), 1e-11);
  EXPECT_GT(difference(a, a.refined(7, 0)), 1e-4);
  const DesignShape b = with_random(DesignShape::bspline(10, square, 2, 3), 2);
  EXPECT_LT(difference(b, b.refined(4, 6)), 1e-11);
  EXPECT_GT(difference(b, b.refined(3, 4)), 1e-4);
  const DesignShape c = with_random(DesignShape::bspline(10, square, 2, 3, ShapeSymmetry::mirror_y), 3);
  EXPECT_LT(difference(c, c.refined(4, 6)), 1e-11);
}

TEST(DesignShape, CountsParameters) {
  const Aperture square = Aperture::rectangle(50, 50);
  EXPECT_EQ(DesignShape::revolution(10, Aperture::circle(50), 8).parameter_count(), 10u);
  EXPECT_EQ(DesignShape::bspline(10, square, 4, 4).parameter_count(), 49u);
  EXPECT_EQ(DesignShape::bspline(10, square, 4, 4, ShapeSymmetry::mirror_x).parameter_count(), 28u);
  EXPECT_EQ(DesignShape::bspline(10, square, 4, 4, ShapeSymmetry::both).parameter_count(), 16u);
}

TEST(DesignShape, HoldsItsSymmetry) {
  const Aperture square = Aperture::rectangle(50, 50);
  const DesignShape y = with_random(DesignShape::bspline(10, square, 3, 4, ShapeSymmetry::mirror_y), 4);
  EXPECT_NEAR(y.at(7, 11).z_mm, y.at(7, -11).z_mm, 1e-12);
  EXPECT_GT(std::abs(y.at(7, 11).z_mm - y.at(-7, 11).z_mm), 1e-3);
  const DesignShape x = with_random(DesignShape::bspline(10, square, 3, 4, ShapeSymmetry::mirror_x), 5);
  EXPECT_NEAR(x.at(7, 11).z_mm, x.at(-7, 11).z_mm, 1e-12);
}

TEST(DesignShape, RangesHoldTheSurface) {
  for (const DesignShape& s : {with_random(DesignShape::revolution(10, Aperture::circle(50), 5), 6),
                               with_random(DesignShape::bspline(10, Aperture::circle(50), 4, 3), 7)}) {
    const auto surface = s.surface();
    const Rectangle r{3, 6, -4, -2};
    const HeightRange range = surface->range(r);
    for (double x = 3; x <= 6; x += 0.1) {
      for (double y = -4; y <= -2; y += 0.1) {
        EXPECT_LE(surface->at(x, y).z_mm, range.high_mm);
        EXPECT_GE(surface->at(x, y).z_mm, range.low_mm);
      }
    }
  }
}

TEST(DesignShape, ATroughIsTheSameAlongY) {
  const DesignShape plain = DesignShape::trough(10, Aperture::rectangle(50, 80), 4);
  EXPECT_EQ(plain.parameter_count(), 7u);
  EXPECT_TRUE(plain.is_trough());
  for (double y = -40; y <= 40; y += 8) EXPECT_NEAR(plain.at(17, y).z_mm, 17.0 * 17.0 / 40.0, 1e-12) << y;
  const DesignShape s = with_random(plain, 9);
  EXPECT_LT(difference(s, s.refined(8, 1)), 1e-10);
  EXPECT_TRUE(s.refined(8, 1).is_trough());
  for (double x = -24; x < 25; x += 3) {
    EXPECT_NEAR(s.at(x, 33).z_mm, s.at(x, -7).z_mm, 1e-11);
    EXPECT_NEAR(s.at(x, 33).dzdy, 0.0, 1e-12);
  }
  const DesignShape mirrored = with_random(DesignShape::trough(10, Aperture::rectangle(50, 80), 4, true), 9);
  EXPECT_EQ(mirrored.parameter_count(), 4u);
  EXPECT_NEAR(mirrored.at(13, 5).z_mm, mirrored.at(-13, 5).z_mm, 1e-12);
  const DesignShape wave = plain.through([](double x, double) { return 0.02 * x * x + 0.1 * x; });
  EXPECT_NEAR(wave.at(11, 20).z_mm, 0.02 * 121 + 1.1, 1e-10);
}

TEST(DesignShape, HeightIsThatOfWhatIsThere) {
  // z = r^2 / 40 from the hole's rim to the outer one.
  const double whole = 25.0 * 25.0 / 40.0, hole = 4.0 * 4.0 / 40.0, corner = 2.0 * whole;
  EXPECT_NEAR(DesignShape::revolution(10, Aperture::circle(50), 5).height_mm(), whole, 1e-9);
  EXPECT_NEAR(DesignShape::revolution(10, Aperture::circle(50, 8), 5).height_mm(), whole - hole, 1e-9);
  EXPECT_NEAR(DesignShape::bspline(10, Aperture::rectangle(50, 50, 8), 4, 4).height_mm(), corner - hole,
              1e-9);
}

TEST(DesignShape, RefusesWhatCannotBe) {
  EXPECT_THROW(DesignShape::revolution(0, Aperture::circle(50), 8), InputError);
  EXPECT_THROW(DesignShape::revolution(10, Aperture::rectangle(50, 50), 8), InputError);
  EXPECT_THROW(DesignShape::bspline(10, Aperture::circle(50), 0, 8), InputError);
}

}  // namespace
}  // namespace lucerna
