// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "lucerna/geometry.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

void expect_orthonormal(const Frame& f) {
  EXPECT_NEAR(length(f.ex()), 1.0, 1e-14);
  EXPECT_NEAR(length(f.ey()), 1.0, 1e-14);
  EXPECT_LT(length(cross(f.ex(), f.ey()) - f.ez()), 1e-14);
}

Direction random_direction(Rng& rng) {
  return Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
}

TEST(Frame, FromAxisPutsZOnTheAxisByTheShortestTurn) {
  Rng rng(3, 0);
  for (int i = 0; i < 500; ++i) {
    const Direction axis = random_direction(rng);
    const Frame f = Frame::from_axis(axis, 0.0, {1, 2, 3});
    expect_orthonormal(f);
    EXPECT_LT(length(f.ez() - axis.vec()), 1e-14);
    // The shortest turn leaves its hinge where it was.
    const Vec3 hinge = cross({0, 0, 1}, axis);
    EXPECT_LT(length(f.vector(hinge) - hinge), 1e-14);
    EXPECT_EQ(f.point({}), (Vec3{1, 2, 3}));
  }
}

TEST(Frame, DownIsAHalfTurnAboutX) {
  const Frame f = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {});
  EXPECT_EQ(f.vector({1, 0, 0}), (Vec3{1, 0, 0}));
  EXPECT_EQ(f.vector({0, 1, 0}), (Vec3{0, -1, 0}));
  EXPECT_EQ(f.vector({0, 0, 1}), (Vec3{0, 0, -1}));
}

TEST(Frame, TurnIsRightHandedAboutTheAxis) {
  const Frame f = Frame::from_axis(Direction(), radians(90.0), {});
  EXPECT_EQ(f.vector({1, 0, 0}), (Vec3{0, 1, 0}));
}

TEST(Frame, InverseAndProductUndoEachOther) {
  Rng rng(4, 0);
  for (int i = 0; i < 200; ++i) {
    const Frame a = Frame::from_axis(random_direction(rng), 6.0 * rng.uniform(), {1, -2, 5});
    const Vec3 p{rng.uniform(), rng.uniform(), rng.uniform()};
    EXPECT_LT(length(a.inverse().point(a.point(p)) - p), 1e-13);
    EXPECT_LT(length((a * a.inverse()).point(p) - p), 1e-13);
  }
}

TEST(Frame, FromZIsOrthonormalForEveryZ) {
  Rng rng(5, 0);
  for (int i = 0; i < 500; ++i) {
    const Direction z = random_direction(rng);
    const Frame f = Frame::from_z(z);
    expect_orthonormal(f);
    EXPECT_EQ(f.ez(), z.vec());
  }
  expect_orthonormal(Frame::from_z(Direction::from({0, 0, -1})));
}

}  // namespace
}  // namespace lucerna
