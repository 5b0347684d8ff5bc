// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "support.h"
#include "surface.h"

#ifdef BENCH_OPENCASCADE
#include <BRepPrimAPI_MakeCylinder.hxx>
#include <BRepPrimAPI_MakeSphere.hxx>
#include <STEPControl_Writer.hxx>
#include <cmath>
#include <sstream>
#endif

namespace bench::test {
namespace {

#ifdef BENCH_OPENCASCADE

std::string step_file(const TestFolder& folder, const TopoDS_Shape& shape) {
  const std::string file = folder.write("a.step", std::string());
  STEPControl_Writer writer;
  writer.Transfer(shape, STEPControl_AsIs);
  writer.Write(file.c_str());
  return file;
}

/// The nearest hit of a ray with a face, through each of its triangles.
bool hit_of(const Surface& surface, const Vec3& o, const Vec3& d, Hit& hit) {
  const Triangles& mesh = surface.triangles();
  bool any = false;
  for (std::size_t k = 0; k < mesh.triangles.size(); ++k) {
    const auto& t = mesh.triangles[k];
    const Vec3 a = mesh.corners[t[0]], e1 = mesh.corners[t[1]] - a, e2 = mesh.corners[t[2]] - a;
    const Vec3 p = cross(d, e2), q = cross(o - a, e1);
    const double det = dot(e1, p);
    if (det == 0.0) continue;
    const double b1 = dot(o - a, p) / det, b2 = dot(d, q) / det, at = dot(e2, q) / det;
    Hit found;
    if (b1 >= 0 && b2 >= 0 && b1 + b2 <= 1 && at > 0 &&
        surface.refine(o, d, {static_cast<std::uint32_t>(k), at, b1, b2}, found) &&
        (!any || found.t < hit.t)) {
      hit = found;
      any = true;
    }
  }
  return any;
}

/// The nearest hit with any face.
bool first_hit(const std::vector<std::unique_ptr<Surface>>& faces, const Vec3& o, const Vec3& d, Hit& hit) {
  bool any = false;
  for (const auto& face : faces) {
    Hit found;
    if (hit_of(*face, o, d, found) && (!any || found.t < hit.t)) {
      hit = found;
      any = true;
    }
  }
  return any;
}

TEST(Step, HitsAreThoseOfTheFacesThemselves) {
  const TestFolder folder;
  const auto ball = read_step(step_file(folder, BRepPrimAPI_MakeSphere(5.0).Shape()), Frame{{0, 0, 20}});
  for (int k = 0; k < 200; ++k) {
    const double a = 0.1 * k, s = 0.02 * k;
    const Vec3 o{s * std::cos(a), s * std::sin(a), 0.0}, d = unit(Vec3{0.01, -0.02, 1.0});
    Hit hit;
    ASSERT_TRUE(first_hit(ball, o, d, hit)) << k;
    const Vec3 at = o + hit.t * d - Vec3{0, 0, 20};
    EXPECT_NEAR(length(at), 5.0, 1e-9);
    // Normals look out of the solid.
    EXPECT_LT(length(hit.normal - (1.0 / 5.0) * at), 1e-9);
  }
}

TEST(Step, EveryFaceOfASolidIsThereAndLooksOut) {
  const TestFolder folder;
  const auto can = read_step(step_file(folder, BRepPrimAPI_MakeCylinder(3.0, 8.0).Shape()), Frame());
  const std::array<Vec3, 4> from{Vec3{1, 1, 4}, {-1, 0.5, 4}, {0.3, -2, 1}, {0, 0.1, 7}};
  for (const Vec3& o : from) {
    for (const Vec3& d : {Vec3{0, 0, 1}, Vec3{0, 0, -1}, Vec3{1, 0, 0}, unit(Vec3{-1, 1, 0.2})}) {
      Hit hit;
      ASSERT_TRUE(first_hit(can, o, d, hit));
      EXPECT_GT(dot(hit.normal, d), 0.0);
      const Vec3 at = o + hit.t * d;
      const bool on_wall = std::abs(std::hypot(at.x, at.y) - 3.0) < 1e-9;
      EXPECT_TRUE(on_wall || std::abs(at.z) < 1e-9 || std::abs(at.z - 8.0) < 1e-9);
    }
  }
}

TEST(Step, WhatIsNoStepFileIsNamed) {
  const TestFolder folder;
  const auto message = [&](const std::string& text) {
    return refusal([&] { read_step(folder.write("a.step", text), Frame()); });
  };
  EXPECT_NE(refusal([] { read_step("none.step", Frame()); }).find("none.step: file: found nothing that"),
            std::string::npos);
  EXPECT_NE(message("solid x").find("expected a STEP file"), std::string::npos);
  const TestFolder other;
  std::ostringstream bytes;
  bytes << std::ifstream(step_file(other, BRepPrimAPI_MakeSphere(5.0).Shape())).rdbuf();
  const std::string whole = bytes.str();
  for (std::size_t size = 0; size + 40 < whole.size(); size += whole.size() / 40)
    EXPECT_NE(message(whole.substr(0, size)).find("expected"), std::string::npos) << size;
}

#else

TEST(Step, WithoutOpenCascadeItIsSaid) {
  EXPECT_NE(refusal([] { read_step("a.step", Frame()); }).find("built without OpenCASCADE"),
            std::string::npos);
}

#endif

}  // namespace
}  // namespace bench::test
