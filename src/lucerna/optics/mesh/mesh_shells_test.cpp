// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/mesh/mesh_shells.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace lucerna {
namespace {

/// A cylinder of radius 2 and height 3 whose foot stands at z.
Mesh cylinder_at(double z) {
  return solid_of_revolution(std::vector<std::array<double, 2>>{{0, z}, {2, z}, {2, z + 3}, {0, z + 3}});
}

/// Both in one mesh; corners of a triangle are its own where `repeated`.
Mesh both_of(const Mesh& a, const Mesh& b, bool repeated) {
  Mesh out;
  for (const Mesh* mesh : {&a, &b}) {
    const auto first = static_cast<std::uint32_t>(out.vertices_mm.size());
    if (!repeated)
      out.vertices_mm.insert(out.vertices_mm.end(), mesh->vertices_mm.begin(), mesh->vertices_mm.end());
    for (const auto& t : mesh->triangles) {
      const auto here = static_cast<std::uint32_t>(out.vertices_mm.size());
      if (repeated) {
        for (const std::uint32_t k : t) out.vertices_mm.push_back(mesh->vertices_mm[k]);
        out.triangles.push_back({here, here + 1, here + 2});
      } else {
        out.triangles.push_back({first + t[0], first + t[1], first + t[2]});
      }
    }
  }
  return out;
}

TEST(MeshShells, VolumeHasTheSignOfTheTriangles) {
  Mesh mesh = cylinder_at(1e6);
  EXPECT_NEAR(signed_volume(mesh), 6.0 * 12.0 * std::numbers::pi, 0.02 * 6.0 * 12.0 * std::numbers::pi);
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  EXPECT_LT(signed_volume(mesh), -6.0 * 11.0 * std::numbers::pi);
}

TEST(MeshShells, AreTakenApartByPlaces) {
  const Mesh one = cylinder_at(0.0), other = cylinder_at(5.0);
  for (const bool repeated : {false, true}) {
    EXPECT_EQ(shells_of(both_of(one, {}, repeated)).size(), 1U);
    const std::vector<Mesh> shells = shells_of(both_of(one, other, repeated));
    ASSERT_EQ(shells.size(), 2U);
    for (const Mesh& shell : shells) {
      EXPECT_EQ(shell.triangles.size(), one.triangles.size());
      EXPECT_NEAR(signed_volume(shell), signed_volume(one), 1e-9);
    }
    EXPECT_GE(shells[1].vertices_mm.front().z, 5.0);
  }
}

}  // namespace
}  // namespace lucerna
