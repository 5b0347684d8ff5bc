// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "support.h"
#include "surface.h"

namespace bench::test {
namespace {

using Facets = std::vector<std::array<Vec3, 4>>;

std::string binary(const Facets& facets, std::uint32_t count) {
  std::string out(80, ' ');
  out.append(reinterpret_cast<const char*>(&count), 4);
  for (const auto& f : facets) {
    for (const Vec3& v : f) {
      const float x[3] = {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
      out.append(reinterpret_cast<const char*>(x), sizeof x);
    }
    out.append(2, '\0');
  }
  return out;
}

const Facets kOne{{Vec3{0, 0, 1}, Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}}};

TEST(Stl, BothFormsAreRead) {
  const TestFolder folder;
  const auto a = read_stl(folder.write("a.stl", binary(kOne, 1)), Frame(), 0.0);
  ASSERT_EQ(a->triangles().triangles.size(), 1u);
  const auto b = read_stl(folder.write("b.stl", std::string("solid x y\nfacet normal 0 0 0\nouter loop\n"
                                                            "vertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
                                                            "endloop\nendfacet\nendsolid x y\n")),
                          Frame{{0, 0, 7}}, 0.0);
  EXPECT_EQ(b->triangles().corners[1].x, 1.0);
  EXPECT_EQ(b->triangles().corners[1].z, 7.0);
  Hit hit;
  ASSERT_TRUE(b->refine({0.2, 0.2, 9}, {0, 0, -1}, {0, 1.9, 0.2, 0.2}, hit));
  EXPECT_DOUBLE_EQ(hit.t, 2.0);
  EXPECT_EQ(hit.normal.z, 1.0);
}

TEST(Stl, BrokenFilesAreRefusedWithTheirPlace) {
  const TestFolder folder;
  const auto message = [&](const std::string& bytes) {
    return refusal([&] { read_stl(folder.write("a.stl", bytes), Frame(), 0.0); });
  };
  EXPECT_NE(refusal([&] { read_stl("none.stl", Frame(), 0.0); }).find("none.stl: file: found nothing"),
            std::string::npos);
  EXPECT_NE(message(binary(kOne, 2)).find("byte 80: found 2 facets in 134 bytes, expected 184 bytes"),
            std::string::npos);
  EXPECT_NE(message("x").find("byte 0: found 1 bytes"), std::string::npos);
  Facets turned = kOne;
  turned[0][0].z = -1.0;
  EXPECT_NE(message(binary(turned, 1)).find("facet 1: found a stored normal against"), std::string::npos);
  Facets wild = kOne;
  wild[0][2].x = std::nan("");
  EXPECT_NE(message(binary(wild, 1)).find("facet 1: found a corner that is not finite"), std::string::npos);
  EXPECT_NE(message("solid\nfacet normal 0 0 one\n").find("line 2: found one, expected a number"),
            std::string::npos);
  EXPECT_NE(message("solid\nfacet normal 0 0 1\nouter loop\n").find("line 3: found the end of the file"),
            std::string::npos);
  Facets flat = kOne;
  flat[0][3] = flat[0][2];
  EXPECT_NE(message(binary(flat, 1)).find("no facet with an area"), std::string::npos);
}

/// A roof of two facets that meet along y at `angle_deg` to each other.
Facets roof(double angle_deg) {
  const double a = 0.5 * angle_deg * std::acos(-1.0) / 180.0, x = std::cos(a), z = -std::sin(a);
  return {{Vec3{}, Vec3{0, 0, 0}, Vec3{x, 0, z}, Vec3{0, 1, 0}},
          {Vec3{}, Vec3{0, 0, 0}, Vec3{0, 1, 0}, Vec3{-x, 0, z}}};
}

// At the ridge the interpolated normal is the mean of both; beyond the crease angle it is the facet's.
TEST(Stl, NormalsAreInterpolatedBelowTheCrease) {
  const TestFolder folder;
  const std::string file = folder.write("roof.stl", binary(roof(8.0), 2));
  const auto tilt = [&](double crease) {
    Hit hit;
    const auto s = read_stl(file, Frame(), crease);
    EXPECT_TRUE(s->refine({0, 0.2, 5}, {0, 0, -1}, {0, 5.0, 0.0, 0.2}, hit));
    return hit.normal.x;
  };
  EXPECT_NEAR(tilt(30.0), 0.0, 1e-12);
  EXPECT_NEAR(tilt(5.0), std::sin(4.0 * kDegree), 1e-6);
  EXPECT_NEAR(tilt(0.0), std::sin(4.0 * kDegree), 1e-6);
}

TEST(Stl, NormalsFarFromTheirFacetAreRefused) {
  const TestFolder folder;
  const std::string file = folder.write("roof.stl", binary(roof(24.0), 2));
  EXPECT_NE(refusal([&] { read_stl(file, Frame(), 30.0); }).find("an interpolated normal 1"),
            std::string::npos);
  EXPECT_EQ(refusal([&] { read_stl(file, Frame(), 0.0); }), "");
  EXPECT_EQ(refusal([&] { read_stl(file, Frame(), 15.0); }), "");
}

// Teeth, wide ones and steep ones, too fine to see: level as a whole, so light must be sent as by a level
// sheet. With normals weighted by the facets' angles it would go some five degrees aside.
TEST(Stl, NormalsOfTeethAreThoseOfTheSheet) {
  const TestFolder folder;
  const double step = std::tan(1.0 * kDegree), steep = std::tan(6.0 * kDegree);
  const double width = step / steep;  // of the steep side, where the wide one has 1
  Facets teeth;
  const auto side = [&](double x0, double z0, double x1, double z1) {
    teeth.push_back({Vec3{}, Vec3{x0, 0, z0}, Vec3{x1, 0, z1}, Vec3{x1, 1, z1}});
    teeth.push_back({Vec3{}, Vec3{x0, 0, z0}, Vec3{x1, 1, z1}, Vec3{x0, 1, z0}});
  };
  for (int k = 0; k < 3; ++k) {
    const double x = k * (1.0 + width);
    side(x, 0.0, x + 1.0, step);
    side(x + 1.0, step, x + 1.0 + width, 0.0);
  }
  const auto s = read_stl(folder.write("teeth.stl", binary(teeth, static_cast<std::uint32_t>(teeth.size()))),
                          Frame(), 30.0);
  Hit hit;
  // The middle of the diagonal of the wide side of the middle tooth.
  ASSERT_TRUE(s->refine({1.5 + width, 0.5, 5}, {0, 0, -1}, {4, 5.0, 0.0, 0.5}, hit));
  EXPECT_LT(std::abs(hit.normal.x), std::sin(0.5 * kDegree));
}

TEST(Stl, AllSolidsOfATextAreRead) {
  const TestFolder folder;
  const auto solid = [](const std::string& z) {
    return "solid solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 " + z + "\nvertex 1 0 " + z +
           "\nvertex 0 1 " + z + "\nendloop\nendfacet\nendsolid solid\n";
  };
  const auto read = [&](const std::string& text) {
    return read_stl(folder.write("a.stl", text), Frame(), 0.0);
  };
  EXPECT_EQ(read(solid("0") + solid("1"))->triangles().triangles.size(), 2u);
  EXPECT_NE(refusal([&] { read(solid("0") + "facet normal"); }).find("line 10: found facet, expected solid"),
            std::string::npos);
}

}  // namespace
}  // namespace bench::test
