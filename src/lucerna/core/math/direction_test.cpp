// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lucerna/geometry.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

TEST(Direction, ReflectionKeepsLengthAndReturns) {
  Rng rng(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const auto draw = [&] {
      return Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
    };
    const Direction in = draw(), normal = draw();
    const Direction out = reflect(in, normal);
    EXPECT_NEAR(length(out), 1.0, 4e-15);
    EXPECT_NEAR(dot(out, normal), -dot(in, normal), 4e-15);
    EXPECT_LT(length(reflect(out, normal).vec() - in.vec()), 4e-15);
  }
}

TEST(Direction, TypeCAnglesFollowTheLuminaireFrame) {
  EXPECT_DOUBLE_EQ(type_c_angles(Direction::from({0, 0, -1})).gamma_rad, 0.0);
  EXPECT_DOUBLE_EQ(degrees(type_c_angles(Direction::from({0, 0, 1})).gamma_rad), 180.0);
  EXPECT_DOUBLE_EQ(degrees(type_c_angles(Direction::from({1, 0, 0})).c_rad), 0.0);
  EXPECT_DOUBLE_EQ(degrees(type_c_angles(Direction::from({0, 1, 0})).c_rad), 90.0);
  EXPECT_DOUBLE_EQ(degrees(type_c_angles(Direction::from({0, -1, 0})).c_rad), 270.0);
  // A tiny negative azimuth must not round up to a full turn, which no table has.
  EXPECT_LT(type_c_angles(Direction::from({1, -1e-300, 0})).c_rad, 2.0 * std::numbers::pi);
}

TEST(Direction, TypeCAnglesInvert) {
  Rng rng(2, 0);
  for (int i = 0; i < 1000; ++i) {
    const Direction d = Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
    EXPECT_LT(length(direction_from_type_c(type_c_angles(d)).vec() - d.vec()), 1e-14);
  }
}

TEST(Direction, AngleIsExactWhereAcosIsNot) {
  const Direction a = Direction::from({0, 0, 1}), b = Direction::from({1e-9, 0, 1});
  EXPECT_NEAR(angle_between(a, b), 1e-9, 1e-24);
  EXPECT_NEAR(angle_between(a, -a), std::numbers::pi, 4e-15);
}

}  // namespace
}  // namespace lucerna
