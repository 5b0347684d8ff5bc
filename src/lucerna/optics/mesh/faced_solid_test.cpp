// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/faced_solid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/faced_outline.h"
#include "tests/support/random_rays.h"
#include "tests/support/spline_face.h"

namespace lucerna {
namespace {

using Outline = std::vector<OutlinePoint>;

const Outline kFlat{{0, 0}, {10, 0}, {10, 3}};
/// A dome cavity of radius 4.
const Outline kDome{{0, 4}, {1.5307, 3.6955}, {2.8284, 2.8284}, {3.6955, 1.5307}, {4, 0}, {10, 0}, {10, 3}};
constexpr double kSmooth = 30.0;

/// No symmetry: a saddle, tilted, with a ripple; the rim is between 4 and 10.
double wavy_top(double x, double y) {
  return 7.0 + 0.012 * x * x - 0.015 * y * y + 0.02 * x + 0.1 * std::sin(0.6 * x + 0.3 * y);
}

double volume_of(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices_mm[t[0]], cross(mesh.vertices_mm[t[1]], mesh.vertices_mm[t[2]])) / 6.0;
  return sum;
}

/// Edges that two triangles run along in the same direction.
std::size_t turned_edges_of(const Mesh& mesh) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> seen;
  std::size_t turned = 0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) turned += seen[{t[k], t[(k + 1) % 3]}]++ > 0 ? 1 : 0;
  }
  return turned;
}

/// Under the face and above z = 0, less the volume that the outline leaves out of it.
double expected_volume(const HeightSurface& face, double radius, double cavity) {
  const int n = 400;
  double sum = 0.0;  // midpoints in r^2 and angle: equal areas
  for (int i = 0; i < n; ++i) {
    const double r = radius * std::sqrt((i + 0.5) / n);
    for (int k = 0; k < n; ++k) {
      const double a = 2.0 * std::numbers::pi * (k + 0.5) / n;
      sum += face.at(r * std::cos(a), r * std::sin(a)).z_mm;
    }
  }
  return sum * std::numbers::pi * radius * radius / (n * n) - cavity;
}

TEST(FacedSolid, IsClosedTurnedOutwardAndHasTheVolume) {
  const auto face = test::spline_face(wavy_top, 11.0, 24);
  const double ball = 2.0 / 3.0 * std::numbers::pi * 64.0;
  for (const auto& [outline, cavity] : {std::pair(kFlat, 0.0), {kDome, ball}}) {
    check_faced_outline(outline, {*face}, kSmooth);
    const double expected = expected_volume(*face, 10.0, cavity);
    for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
      const Mesh solid = faced_solid(outline, {*face}, kSmooth, tolerance);
      EXPECT_EQ(open_edges(solid), 0u);
      EXPECT_EQ(turned_edges_of(solid), 0u);
      // The dome is a spline through five corners, 1e-3 off the sphere's volume.
      EXPECT_NEAR(volume_of(solid), expected, expected * (10.0 * tolerance + (cavity > 0.0 ? 1e-3 : 1e-5)));
    }
  }
}

// The bottom, of radius 6, leaves out what is below it and above the flange.
TEST(FacedSolid, ABottomFaceLeavesItsHollowOut) {
  const auto top = test::spline_face(wavy_top, 11.0, 24);
  const auto bottom = test::spline_face(
      [](double x, double y) { return 3.0 - 0.04 * x * x + 0.02 * y * y + 0.1 * std::sin(x); }, 7.0, 24);
  const Outline outline{{6, 1}, {6, 0}, {10, 0}, {10, 3}};
  check_faced_outline(outline, {*top, bottom.get()}, kSmooth);
  const double expected = expected_volume(*top, 10.0, expected_volume(*bottom, 6.0, 0.0));
  for (const double tolerance : {1e-3, 1e-4, 1e-5}) {
    const Mesh solid = faced_solid(outline, {*top, bottom.get()}, kSmooth, tolerance);
    EXPECT_EQ(open_edges(solid), 0u);
    EXPECT_EQ(turned_edges_of(solid), 0u);
    EXPECT_NEAR(volume_of(solid), expected, expected * (10.0 * tolerance + 1e-5));
  }
}

TEST(FacedSolid, NoTriangleIsASliver) {
  const auto face = test::spline_face(wavy_top, 11.0, 24);
  const Mesh solid = faced_solid(kFlat, {*face}, kSmooth, 1e-4);
  for (const auto& t : solid.triangles) {
    const Vec3 &a = solid.vertices_mm[t[0]], &b = solid.vertices_mm[t[1]], &c = solid.vertices_mm[t[2]];
    if (a.z < 3.0 || b.z < 3.0 || c.z < 3.0 || std::hypot(a.x, a.y) > 8.0) continue;  // inside the face
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    EXPECT_GT(length(cross(b - a, c - a)) / (longest * longest), 0.15);
  }
}

TEST(FacedSolid, TrianglesAreOnTheSurface) {
  const auto face = test::spline_face(wavy_top, 11.0, 24);
  constexpr double kTolerance = 1e-5;
  const Mesh solid = faced_solid(kFlat, {*face}, kSmooth, kTolerance);
  const double reach = faced_reach_mm(kFlat, {*face});
  double off = 0.0;
  std::size_t of_face = 0, of_wall = 0, of_base = 0;
  for (const auto& t : solid.triangles) {
    const Vec3 &a = solid.vertices_mm[t[0]], &b = solid.vertices_mm[t[1]], &c = solid.vertices_mm[t[2]];
    const Vec3 p = (1.0 / 3.0) * (a + b + c), flat = cross(b - a, c - a);
    const SurfacePoint at = face->at(p.x, p.y);
    if (std::abs(at.z_mm - p.z) < 1e-2 && flat.z > 0.0) {
      ++of_face;
      off = std::max(off, std::abs(at.z_mm - p.z));
      const Vec3 exact = Direction::from({-at.dzdx, -at.dzdy, 1.0}).vec();
      ASSERT_GT(dot(Direction::from(flat).vec(), exact), 0.999);
    } else if (flat.z < -0.5 * length(flat)) {
      ++of_base;
      EXPECT_EQ(p.z, 0.0);
    } else {
      ++of_wall;
      EXPECT_NEAR(std::hypot(p.x, p.y), 10.0, 10.0 * kTolerance);
    }
  }
  // Middles of sides are held to the tolerance; those of triangles are a third farther off.
  EXPECT_LT(off, 1.5 * kTolerance * reach);
  EXPECT_GT(std::min({of_face, of_wall, of_base}), 100u);
}

TEST(FacedSolid, AnOutlineThatDoesNotFitIsRefused) {
  const auto face = test::spline_face(wavy_top, 11.0, 24);
  const auto expect = [&](const Outline& outline, const std::string& part, const HeightSurface& over) {
    EXPECT_THAT(test::message_of<InputError>([&] { check_faced_outline(outline, {over}, kSmooth); }),
                testing::HasSubstr(part));
  };
  expect({{0, 0}, {10, 0}}, "found 2 corners", *face);
  expect({{1, 0}, {10, 0}, {10, 3}}, "first corner at [1, 0], expected it on the axis", *face);
  expect({{0, 0}, {10, 0}, {9, 3}}, "from [10, 0] to [9, 3], expected a wall", *face);
  expect({{0, 4}, {10, 4}, {10, 3}}, "expected a wall", *face);
  expect({{0, 0}, {6, 2}, {6, -1}, {3, 3}, {10, 0}, {10, 3}}, "crosses itself", *face);
  expect({{0, 0}, {9, 0}, {10, 5}, {10, 8}}, "degrees into the wall, at [10, 5], expected an edge", *face);
  expect({{0, 7.5}, {4, 0}, {10, 0}, {10, 3}}, "expected it above the outline below, z = 7.5", *face);
  expect({{0, 0}, {8, 0}, {10, 5.9}, {10, 6}}, "expected an edge", *face);
  expect({{0, 0}, {12, 0}, {12, 6.5}, {10, 6.5}, {10, 7}}, "at its rim", *face);
  const auto broken =
      test::spline_face([](double, double) { return std::numeric_limits<double>::quiet_NaN(); }, 11.0, 4);
  expect(kFlat, "no finite height and slope", *broken);
}

}  // namespace
}  // namespace lucerna
