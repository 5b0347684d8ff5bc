// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/refracting_sphere.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"
#include "lucerna/source/emitters/warp.h"

namespace lucerna {
namespace {

const RefractingSphere kDome{{0.3, -0.2, 0.5}, 1.4, 1.53};

/// A line that passes the dome's centre at `offset` radii.
Ray line_at(double offset, std::uint64_t i) {
  Rng rng(3, i);
  const double a = rng.uniform(), b = rng.uniform(), c = rng.uniform(), e = rng.uniform();
  const Direction d = warp::sphere(a, b);
  const Frame across = Frame::from_z(d, kDome.centre_mm);
  const Vec3 q = offset * kDome.radius_mm * Vec3{std::cos(7.0 * c), std::sin(7.0 * c), 0.0};
  return {across.point(q + Vec3{0, 0, 10.0 * e - 5.0}), d};
}

TEST(RefractingSphere, SnellsLawHoldsWhereTheLineLeaves) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Ray out = line_at(0.0005 * static_cast<double>(i), i);
    const auto in = kDome.inside(out);
    ASSERT_TRUE(in.has_value());
    const Vec3 normal = (in->origin_mm - kDome.centre_mm) / kDome.radius_mm;
    ASSERT_NEAR(length(normal), 1.0, 1e-12);
    ASSERT_LT(length(cross(in->origin_mm - out.origin_mm, out.direction.vec())), 1e-12);
    ASSERT_GE(dot(normal, out.direction.vec()), 0.0);
    ASSERT_GE(dot(normal, in->direction.vec()), 0.0);
    // n sin(theta) about the same normal, as vectors: Snell's law and the plane of incidence in one.
    const Vec3 change = cross(normal, kDome.index * in->direction.vec() - out.direction.vec());
    ASSERT_LT(length(change), 1e-12);
  }
}

TEST(RefractingSphere, OutsideUndoesInside) {
  for (std::uint64_t i = 0; i < 2000; ++i) {
    const Ray out = line_at(0.000499 * static_cast<double>(i), i);
    const auto in = kDome.inside(out);
    ASSERT_TRUE(in.has_value());
    // Anywhere on the inner line.
    const Ray back = kDome.outside({in->at(-0.7), in->direction});
    ASSERT_LT(length(back.direction.vec() - out.direction.vec()), 1e-9) << i;
    ASSERT_LT(length(cross(back.origin_mm - out.origin_mm, out.direction.vec())), 1e-9) << i;
  }
}

TEST(RefractingSphere, LinesThatMissItHaveNoInside) {
  EXPECT_FALSE(kDome.inside(line_at(1.001, 1)).has_value());
  EXPECT_TRUE(kDome.inside(line_at(0.999, 1)).has_value());
}

TEST(RefractingSphere, WhatWouldBeReflectedLeavesAlongTheSurface) {
  RefractingSphere weak = kDome;
  weak.index = 1.0;  // any line through the ball as it is
  for (const double offset : {1.001 / kDome.index, 0.9, 1.5}) {
    const Ray inner = line_at(offset, 5);
    const Ray out = kDome.outside(inner);
    const Vec3 normal = (out.origin_mm - kDome.centre_mm) / kDome.radius_mm;
    EXPECT_NEAR(length(normal), 1.0, 1e-9);
    EXPECT_NEAR(dot(normal, out.direction.vec()), 0.0, 1e-3);
    EXPECT_NEAR(length(out.direction.vec()), 1.0, 1e-9);
  }
  EXPECT_LT(length(weak.outside(line_at(0.5, 2)).direction.vec() - line_at(0.5, 2).direction.vec()), 1e-9);
}

TEST(RefractingSphere, TheImageOfThePointAtTheCentreIsTheCentre) {
  for (std::uint64_t i = 0; i < 50; ++i) {
    const Ray out = kDome.outside({kDome.centre_mm, line_at(0.0, i).direction});
    EXPECT_LT(length(cross(out.origin_mm - kDome.centre_mm, out.direction.vec())), 1e-12);
  }
}

}  // namespace
}  // namespace lucerna
