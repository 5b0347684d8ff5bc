// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/mesh_tolerance.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

TargetRectangle directions(double width, double height) {
  TargetRectangle r;
  r.u_min = -0.5 * width;
  r.u_max = 0.5 * width;
  r.v_min = -0.5 * height;
  r.v_max = 0.5 * height;
  return r;
}

TEST(MeshTolerance, IsAFifthOfTheShorterSideOfABox) {
  EXPECT_NEAR(mesh_tolerance(directions(0.9, 0.75), {}).slope_deg, 0.2 * degrees(0.75 / 48.0), 1e-12);
  EXPECT_EQ(mesh_tolerance(directions(0.9, 0.75), {}).chord_mm, kOpticalTolerance.chord_mm);
}

TEST(MeshTolerance, StaysWithinItsLimits) {
  EXPECT_EQ(mesh_tolerance(directions(2.0, 2.0), {}).slope_deg, kOpticalTolerance.slope_deg);
  EXPECT_NEAR(mesh_tolerance(directions(0.01, 2.0), {}).slope_deg, 0.15, 1e-12);
}

TEST(MeshTolerance, OfAPlaneGoesByItsDistance) {
  TargetRectangle wall = directions(2400.0, 2400.0);
  wall.is_plane = true;
  wall.world_from_rectangle = Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 3000.0});
  EXPECT_NEAR(mesh_tolerance(wall, {0, 0, 0}).slope_deg, 0.2 * degrees(std::atan(50.0 / 3000.0)), 1e-12);
  EXPECT_GT(mesh_tolerance(wall, {0, 0, 1000}).slope_deg, mesh_tolerance(wall, {0, 0, 0}).slope_deg);
  EXPECT_EQ(mesh_tolerance(wall, {0, 0, 3000}).slope_deg, kOpticalTolerance.slope_deg) << "on the plane";
}

}  // namespace
}  // namespace lucerna
