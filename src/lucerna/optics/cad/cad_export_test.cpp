// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <sstream>

#include "lucerna/cad.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/optics/shapes/smooth_shape.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

Reflector wavy(const Aperture& aperture) {
  const double a = aperture.half_x_mm(), b = aperture.half_y_mm();
  const KnotRow x{-a, 2.0 * a / 3.0, 3}, y{-b, 2.0 * b / 2.0, 2};
  std::vector<double> c(30);
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = 0.4 * std::sin(2.0 * static_cast<double>(i));
  return {std::make_shared<SmoothSurface<BsplineShape>>(BsplineShape(15.0, x, y, c)), aperture};
}

double distance(const Reflector& r, const Vec3& p) {
  const SurfacePoint s = r.surface->at(p.x, p.y);
  return std::abs(p.z - s.z_mm) / std::sqrt(1.0 + s.dzdx * s.dzdx + s.dzdy * s.dzdy);
}

TEST(CadExport, FilesReadBackWithinTheTolerance) {
  const test::TempDir folder;
  for (const Aperture& aperture : {Aperture::circle(50), Aperture::circle(50, 10),
                                   Aperture::rectangle(60, 40), Aperture::rectangle(60, 40, 10)}) {
    const Reflector reflector = wavy(aperture);
    const Mesh mesh = cad_mesh(reflector, {.chord_mm = 0.02, .slope_deg = 60.0});
    write_file(folder / "m.stl", stl_bytes(mesh));
    write_file(folder / "m.obj", obj_text(mesh));
    for (const Mesh& read : {read_stl(folder / "m.stl"), read_obj(folder / "m.obj")}) {
      ASSERT_EQ(read.triangles.size(), mesh.triangles.size());
      double worst = 0.0, area = 0.0;
      for (const auto& t : read.triangles) {
        const Vec3 &a = read.vertices_mm[t[0]], &b = read.vertices_mm[t[1]], &c = read.vertices_mm[t[2]];
        for (const Vec3& p : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (a + c)}) {
          worst = std::max(worst, distance(reflector, p));
        }
        const Vec3 normal = cross(b - a, c - a);
        EXPECT_GT(normal.z, 0.0);  // towards the light
        area += 0.5 * normal.z;
      }
      EXPECT_LT(worst, 0.021);
      EXPECT_GT(worst, 0.001);
      const double r = aperture.half_x_mm(), hole = aperture.hole_radius_mm();
      const double exact = aperture.shape() == ApertureShape::circle
                               ? std::numbers::pi * (r * r - hole * hole)
                               : 4.0 * r * aperture.half_y_mm() - std::numbers::pi * hole * hole;
      EXPECT_NEAR(area / exact, 1.0, 0.002);
    }
  }
}

TEST(CadExport, PiecesKeepTheSlopeTolerance) {
  for (const Aperture& aperture : {Aperture::circle(50, 10), Aperture::rectangle(60, 40)}) {
    const Reflector reflector = wavy(aperture);
    const Mesh mesh = cad_mesh(reflector, {.chord_mm = 1.0, .slope_deg = 3.0});
    double worst = 0.0;
    for (const auto& t : mesh.triangles) {
      const Vec3 &a = mesh.vertices_mm[t[0]], &b = mesh.vertices_mm[t[1]], &c = mesh.vertices_mm[t[2]];
      const Direction normal = Direction::from(cross(b - a, c - a));
      for (const Vec3& p : {a, b, c}) {
        const SurfacePoint s = reflector.surface->at(p.x, p.y);
        worst = std::max(worst, angle_between(normal, Direction::from(Vec3{-s.dzdx, -s.dzdy, 1.0})));
      }
    }
    EXPECT_LT(degrees(worst), 3.0);
    EXPECT_GT(degrees(worst), 1.0);
  }
}

TEST(CadExport, WhatAMillionTrianglesCannotKeepIsRaisedByLittle) {
  const Reflector reflector = wavy(Aperture::circle(50, 10));
  int raised = 0;
  for (const double slope_deg : {0.04, 0.06, 0.09, 3.0}) {
    CadTolerance tolerance{.chord_mm = 1.0, .slope_deg = slope_deg};
    const Mesh mesh = cad_mesh_within(reflector, tolerance);
    const double factor = tolerance.slope_deg / slope_deg;
    EXPECT_NEAR(tolerance.chord_mm, factor, 1e-12);
    EXPECT_LE(mesh.triangles.size(), std::size_t{1} << 20);
    EXPECT_EQ(mesh.triangles.size(), cad_mesh(reflector, tolerance).triangles.size());
    if (factor == 1.0) continue;
    ++raised;
    const CadTolerance finer{tolerance.chord_mm / 1.2, tolerance.slope_deg / 1.2};
    EXPECT_GT(cad_mesh(reflector, finer).triangles.size(), std::size_t{1} << 20) << slope_deg;
  }
  EXPECT_EQ(raised, 3);
}

TEST(CadExport, RimsKeepTheChordTolerance) {
  const Mesh mesh = cad_mesh(wavy(Aperture::circle(50, 10)), {.chord_mm = 0.01, .slope_deg = 80.0});
  double min = 1e9, widest = 0.0;
  for (const auto& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 middle = 0.5 * (mesh.vertices_mm[t[k]] + mesh.vertices_mm[t[(k + 1) % 3]]);
      min = std::min(min, std::hypot(middle.x, middle.y));
      widest = std::max(widest, std::hypot(middle.x, middle.y));
    }
  }
  EXPECT_GT(min, 4.99);
  EXPECT_GT(widest, 24.99);
}

TEST(CadExport, ProfilesKeepTheTolerance) {
  const Reflector reflector = wavy(Aperture::circle(50, 10));
  const auto profile = cad_profile(reflector, {.chord_mm = 0.005, .slope_deg = 60.0});
  EXPECT_EQ(profile.front()[0], 5.0);
  EXPECT_EQ(profile.back()[0], 25.0);
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const auto &p = profile[i - 1], &q = profile[i];
    EXPECT_LT(distance(reflector, {0.5 * (p[0] + q[0]), 0.0, 0.5 * (p[1] + q[1])}), 0.0051);
  }
  std::istringstream dxf(dxf_profile(profile));
  std::string code, value;
  std::size_t vertices = 0;
  double last_x = 0.0;
  while (std::getline(dxf, code) && std::getline(dxf, value)) {
    if (code == "0" && value == "VERTEX") ++vertices;
    if (code == "10") last_x = std::stod(value);
  }
  EXPECT_EQ(value, "EOF");
  EXPECT_EQ(vertices, profile.size());
  EXPECT_EQ(last_x, 25.0);
  EXPECT_NE(csv_profile(profile).find("\n5,"), std::string::npos);
}

TEST(CadExport, RefusesSenselessTolerances) {
  EXPECT_THROW(cad_mesh(wavy(Aperture::circle(50)), {.chord_mm = 0.0}), InputError);
  EXPECT_THROW(cad_mesh(wavy(Aperture::circle(50)), {.chord_mm = 1e-9}), InputError);
  EXPECT_THROW(cad_mesh(wavy(Aperture::circle(50)), {.slope_deg = 0.0}), InputError);
}

// Their steps are finer than any mesh: coarser tolerances would not help.
TEST(CadExport, RefusesFacetsByName) {
  const Reflector smooth = wavy(Aperture::circle(50));
  const Reflector faceted{std::make_shared<FacetedSurface>(smooth.surface, 5.0, INFINITY), smooth.aperture};
  try {
    static_cast<void>(cad_mesh(faceted, {.chord_mm = 1.0, .slope_deg = 45.0}));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("faceted mirror steps where its facets of 5 mm meet"),
              std::string::npos)
        << e.what();
  }
}

}  // namespace
}  // namespace lucerna
