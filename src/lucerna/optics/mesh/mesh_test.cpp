// SPDX-License-Identifier: Apache-2.0
#include "lucerna/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <numbers>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

const std::string kTetrahedron =
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\n# faces\nf 1 3 2\nf 1/1 2/2 4/3\nf -4 -1 -2\nf 2//1 3//1 4//1\n";

std::string binary_stl(const Mesh& mesh) {
  std::string s(80, 's');
  const auto n = static_cast<std::uint32_t>(mesh.triangles.size());
  s.append(reinterpret_cast<const char*>(&n), 4);
  for (const auto& t : mesh.triangles) {
    float v[12] = {};
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3& p = mesh.vertices_mm[t[k]];
      v[3 + 3 * k] = static_cast<float>(p.x);
      v[4 + 3 * k] = static_cast<float>(p.y);
      v[5 + 3 * k] = static_cast<float>(p.z);
    }
    s.append(reinterpret_cast<const char*>(v), sizeof v);
    s.append(2, '\0');
  }
  return s;
}

TEST(Mesh, ObjAndStlHoldTheSameBody) {
  const test::TempDir dir;
  write_file(dir / "t.obj", kTetrahedron);
  const Mesh obj = read_mesh(dir / "t.obj");
  EXPECT_EQ(obj.vertices_mm.size(), 4u);
  EXPECT_EQ(obj.triangles.size(), 4u);
  EXPECT_EQ(open_edges(obj), 0u);
  write_file(dir / "t.STL", binary_stl(obj));
  const Mesh stl = read_mesh(dir / "t.STL");
  EXPECT_EQ(stl.vertices_mm.size(), 4u);
  EXPECT_EQ(open_edges(stl), 0u);
  Mesh open = stl;
  open.triangles.pop_back();
  EXPECT_EQ(open_edges(open), 3u);
}

TEST(Mesh, TextStl) {
  const test::TempDir dir;
  write_file(dir / "t.stl",
             "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\n vertex 1 0 0\r\nvertex 0 1e0 "
             "0\nendloop\nendfacet\nendsolid x\n");
  const Mesh m = read_stl(dir / "t.stl");
  ASSERT_EQ(m.triangles.size(), 1u);
  EXPECT_EQ(m.vertices_mm[2], (Vec3{0, 1, 0}));
  write_file(dir / "upper.stl",
             "SOLID X\nFACET NORMAL 0 0 1\nOUTER LOOP\nVERTEX 0 0 0\nVERTEX 1 0 0\nVERTEX 0 1E0 "
             "0\nENDLOOP\nENDFACET\nENDSOLID X\n");
  EXPECT_EQ(read_stl(dir / "upper.stl").vertices_mm, m.vertices_mm);
}

TEST(Mesh, BadFilesAreRefused) {
  const test::TempDir dir;
  const auto refused = [&](const char* name, const std::string& text) {
    write_file(dir / name, text);
    EXPECT_THROW(read_mesh(dir / name), InputError) << text.substr(0, 60);
  };
  refused("a.obj", "v 0 0 nan\n");
  refused("b.obj", "v 0 0 0\nf 1 2 3\n");
  refused("c.obj", "v 0 0 0\n");
  refused("d.obj", "v 0 0 0\nf 1 1\n");
  refused("a.stl", "");
  refused("b.stl", std::string(84, '\xff'));
  refused("c.stl", "solid\nfacet\nvertex 0 0 0\nendfacet\n");
  refused("d.stl", "solid\n");
  refused("e.ply", "ply\n");
  write_file(dir / "t.obj", kTetrahedron);
  const std::string good = binary_stl(read_mesh(dir / "t.obj"));
  refused("cut.stl", good.substr(0, good.size() - 1));
}

/// A sphere of radius 10 from `rings` by 2 `rings` squares.
Mesh sphere(std::size_t rings) {
  Mesh mesh;
  const std::size_t turns = 2 * rings;
  for (std::size_t i = 0; i <= rings; ++i) {
    const double theta = std::numbers::pi * static_cast<double>(i) / static_cast<double>(rings);
    for (std::size_t j = 0; j < turns; ++j) {
      const double phi = 2.0 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(turns);
      mesh.vertices_mm.push_back({10.0 * std::sin(theta) * std::cos(phi),
                                  10.0 * std::sin(theta) * std::sin(phi), 10.0 * std::cos(theta)});
    }
  }
  const auto at = [&](std::size_t i, std::size_t j) {
    return static_cast<std::uint32_t>(i * turns + j % turns);
  };
  for (std::size_t i = 0; i < rings; ++i) {
    for (std::size_t j = 0; j < turns; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

TEST(Mesh, CornerNormalsOfASphereAreRadialAndOfACubeSharp) {
  double worst[2] = {0.0, 0.0};
  for (const std::size_t fine : {std::size_t{0}, std::size_t{1}}) {
    const Mesh mesh = sphere(fine == 0 ? 20 : 40);
    const auto normals = corner_normals(mesh, 60.0);
    ASSERT_EQ(normals.size(), 3 * mesh.triangles.size());
    for (std::size_t c = 0; c < normals.size(); ++c) {
      const Vec3& p = mesh.vertices_mm[mesh.triangles[c / 3][c % 3]];
      if (std::abs(p.z) > 9.5) continue;  // poles are fans of slivers
      worst[fine] = std::max(worst[fine], length(normals[c] - 0.1 * p));
    }
  }
  EXPECT_LT(worst[0], 0.02);
  EXPECT_LT(worst[1], 0.3 * worst[0]) << "the error falls with the square of the size";
  // The corner of a tetrahedron's base: with a crease below the angles between faces each face stays flat.
  const test::TempDir dir;
  write_file(dir / "t.obj", kTetrahedron);
  const Mesh tetrahedron = read_mesh(dir / "t.obj");
  const auto sharp = corner_normals(tetrahedron, 30.0), round = corner_normals(tetrahedron, 180.0);
  EXPECT_EQ(sharp[0], (Vec3{0, 0, -1}));
  EXPECT_LT(length(round[0] - (-1.0 / std::sqrt(3.0)) * Vec3{1, 1, 1}), 1e-12);
}

using Outline = std::vector<std::array<double, 2>>;

/// Of a closed mesh whose triangles are counter-clockwise seen from outside; else below 0.
double volume(const Mesh& mesh) {
  double sum = 0.0;
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices_mm[t[0]], cross(mesh.vertices_mm[t[1]], mesh.vertices_mm[t[2]])) / 6.0;
  return sum;
}

TEST(SolidOfRevolution, IsClosedAndHasItsVolumeHoweverItsOutlineRuns) {
  const double pi = std::numbers::pi;
  // Within the circle by (sin x) / x of its area, x = 2 pi / 360.
  const double round = std::sin(2.0 * pi / 360.0) / (2.0 * pi / 360.0);
  Outline cylinder{{0, -1}, {5, -1}, {5, 3}, {0, 3}}, ring{{4, 0}, {6, 0}, {6, 2}, {4, 2}},
      cone{{0, 0}, {3, 9}, {0, 9}};
  for (int turned = 0; turned < 2; ++turned) {
    for (const auto& [outline, expected] :
         {std::pair{cylinder, pi * 100.0}, {ring, pi * 40.0}, {cone, pi * 27.0}}) {
      const Mesh mesh = solid_of_revolution(outline);
      EXPECT_EQ(open_edges(mesh), 0U);
      EXPECT_NEAR(volume(mesh), round * expected, 1e-9 * expected);
    }
    for (Outline* o : {&cylinder, &ring, &cone}) std::reverse(o->begin(), o->end());
  }
}

TEST(SolidOfRevolution, RefusesWhatIsNoOutline) {
  const auto message = [](const Outline& outline) {
    return test::message_of<InputError>([&] { (void)solid_of_revolution(outline); });
  };
  EXPECT_NE(message({{0, 0}, {1, 0}}).find("2 corners, expected at least 3"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {-1, 0}, {1, 2}}).find("corner 2 of the outline is [-1, 0]"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 0}, {1, 0}, {0, 1}}).find("corners 2 and 3 of the outline are equal"),
            std::string::npos);
  EXPECT_NE(message({{0, 0}, {2, 2}, {2, 0}, {1, 3}}).find("crosses itself"), std::string::npos);
  EXPECT_NE(message({{0, 0}, {1, 0}, {2, 0}}).find("no area"), std::string::npos);
}

}  // namespace
}  // namespace lucerna
