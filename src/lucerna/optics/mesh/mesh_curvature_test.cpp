// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/mesh_curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace lucerna {
namespace {

/// z over rings about the axis, each a little turned from the one within, and nearly as wide as it in places:
/// triangles a hundred times longer than wide stand beside square ones.
Mesh rings(const std::function<double(double, double)>& z) {
  constexpr std::uint32_t kAround = 90;
  std::vector<double> radii;
  for (int i = 1; i <= 30; ++i) {
    radii.push_back(i);
    if (i % 5 == 0) radii.push_back(i + 0.01);
  }
  Mesh mesh;
  mesh.vertices_mm.push_back({0.0, 0.0, z(0.0, 0.0)});
  for (std::size_t j = 0; j < radii.size(); ++j) {
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const double angle =
          2.0 * std::numbers::pi * (i + 0.37 * static_cast<double>(j)) / static_cast<double>(kAround);
      const double x = radii[j] * std::cos(angle), y = radii[j] * std::sin(angle);
      mesh.vertices_mm.push_back({x, y, z(x, y)});
    }
  }
  const auto at = [&](std::size_t j, std::uint32_t i) {
    return static_cast<std::uint32_t>(1 + j * kAround + i % kAround);
  };
  for (std::uint32_t i = 0; i < kAround; ++i) mesh.triangles.push_back({0, at(0, i), at(0, i + 1)});
  for (std::size_t j = 0; j + 1 < radii.size(); ++j) {
    for (std::uint32_t i = 0; i < kAround; ++i) {
      mesh.triangles.push_back({at(j, i), at(j + 1, i), at(j + 1, i + 1)});
      mesh.triangles.push_back({at(j, i), at(j + 1, i + 1), at(j, i + 1)});
    }
  }
  return mesh;
}

TEST(MeshCurvature, OfASphereThoughTrianglesAreNarrow) {
  const Mesh mesh = rings([](double x, double y) { return 50.0 - std::sqrt(2500.0 - x * x - y * y); });
  EXPECT_NEAR(1.0 / max_curvature_per_mm(mesh), 50.0, 0.5);
}

TEST(MeshCurvature, OfAParaboloidIsThatOfItsVertex) {
  const Mesh mesh = rings([](double x, double y) { return (x * x + y * y) / 80.0; });
  EXPECT_NEAR(1.0 / max_curvature_per_mm(mesh), 40.0, 0.04);
}

TEST(MeshCurvature, IsTheStrongerOfTwoWhateverItsSign) {
  const Mesh saddle = rings([](double x, double y) { return x * x / 200.0 - y * y / 60.0; });
  EXPECT_NEAR(1.0 / max_curvature_per_mm(saddle), 30.0, 0.03);
}

TEST(MeshCurvature, DoesNotDependOnTheLengthsUnitOrTheSurfacesPlace) {
  Mesh mesh = rings([](double x, double y) { return (x * x + y * y) / 80.0; });
  for (Vec3& v : mesh.vertices_mm) v = {1e-3 * v.z, 1e-3 * v.x - 7.0, 1e-3 * v.y + 3.0};
  EXPECT_NEAR(1e3 / max_curvature_per_mm(mesh), 40.0, 0.04);
}

TEST(MeshCurvature, OfAPlaneIsNone) {
  EXPECT_LT(max_curvature_per_mm(rings([](double x, double) { return 0.3 * x; })), 1e-9);
}

TEST(MeshCurvature, OfTooFewCornersIsNotKnown) {
  Mesh mesh;
  mesh.vertices_mm = {{0, 0, 0}, {1, 0, 0}, {1, 1, 1}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_EQ(max_curvature_per_mm(mesh), 0.0);
}

}  // namespace
}  // namespace lucerna
