// SPDX-License-Identifier: Apache-2.0
// STEP files read by another program: OpenCASCADE, where it is installed.
#include <gtest/gtest.h>

#include <BRepBndLib.hxx>
#include <BRepBuilderAPI_MakeVertex.hxx>
#include <BRepCheck_Analyzer.hxx>
#include <BRepExtrema_DistShapeShape.hxx>
#include <BRepGProp.hxx>
#include <Bnd_Box.hxx>
#include <GProp_GProps.hxx>
#include <STEPControl_Reader.hxx>
#include <TopExp_Explorer.hxx>
#include <array>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/core/io/file.h"
#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/scene.h"
#include "tests/support/spline_face.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

Reflector free_form(const Aperture& aperture) {
  const double a = aperture.half_x_mm(), b = aperture.half_y_mm();
  const KnotRow x{-a, 2.0 * a / 4, 4}, y{-b, 2.0 * b / 4, 4};
  std::vector<double> c(49);
  for (std::size_t i = 0; i < c.size(); ++i) c[i] = 0.4 * std::sin(2.0 * static_cast<double>(i));
  return {std::make_shared<SmoothSurface<BsplineShape>>(BsplineShape(15.0, x, y, c)), aperture};
}

Reflector turned(const Aperture& aperture) {
  const KnotRow row{0.0, aperture.half_x_mm() / 6, 6};
  std::vector<double> c{0.3, -0.2, 0.3, 0.1, -0.4, 0.2, 0.5, -0.1, 0.2};
  return {std::make_shared<SmoothSurface<RevolutionShape>>(RevolutionShape(12.0, row, c)), aperture};
}

double area_of(const Mesh& mesh) {
  double area = 0.0;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices_mm[t[0]], &b = mesh.vertices_mm[t[1]], &c = mesh.vertices_mm[t[2]];
    area += 0.5 * length(cross(b - a, c - a));
  }
  return area;
}

TEST(StepOpenCascade, ReadsTheSameSurfaceAreaAndEnvelope) {
  const test::TempDir folder;
  for (const Reflector& reflector :
       {free_form(Aperture::rectangle(60, 40)), free_form(Aperture::circle(50)),
        free_form(Aperture::circle(50, 8)), free_form(Aperture::rectangle(60, 40, 8)),
        turned(Aperture::circle(50)), turned(Aperture::circle(50, 8))}) {
    write_file(folder / "m.step", step_text(reflector));
    STEPControl_Reader reader;
    ASSERT_EQ(reader.ReadFile((folder / "m.step").c_str()), IFSelect_RetDone);
    ASSERT_GT(reader.TransferRoots(), 0);
    const TopoDS_Shape shape = reader.OneShape();
    EXPECT_TRUE(BRepCheck_Analyzer(shape).IsValid());

    const Mesh mesh = cad_mesh(reflector, {.chord_mm = 0.002, .slope_deg = 60.0});
    GProp_GProps properties;
    BRepGProp::SurfaceProperties(shape, properties);
    EXPECT_NEAR(properties.Mass() / area_of(mesh), 1.0, 1e-3);

    Vec3 low{1e9, 1e9, 1e9}, high{-1e9, -1e9, -1e9};
    for (const auto& t : mesh.triangles) {
      for (const std::uint32_t i : t) {
        const Vec3& v = mesh.vertices_mm[i];
        low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
        high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
      }
    }
    Bnd_Box box;
    BRepBndLib::AddOptimal(shape, box, false, false);
    // Beneath a hole the box may hold what the trimmed surface does not.
    double x0 = 0.0, y0 = 0.0, z0 = 0.0, x1 = 0.0, y1 = 0.0, z1 = 0.0;
    box.Get(x0, y0, z0, x1, y1, z1);
    for (const auto& [a, b] : {std::pair{x0, low.x}, std::pair{y0, low.y},
                               std::pair{z0, reflector.aperture.hole_radius_mm() > 0.0 ? z0 : low.z},
                               std::pair{x1, high.x}, std::pair{y1, high.y}, std::pair{z1, high.z}}) {
      EXPECT_NEAR(a, b, 0.02);
    }
    // Points of the traced surface lie on the shape that the other program has.
    for (const double r : {6.0, 12.0, 19.0}) {
      for (const double angle : {0.3, 2.1, 4.0, 5.9}) {
        const double x = r * std::cos(angle), y = r * std::sin(angle);
        const TopoDS_Shape vertex =
            BRepBuilderAPI_MakeVertex(gp_Pnt(x, y, reflector.surface->at(x, y).z_mm)).Shape();
        EXPECT_LT(BRepExtrema_DistShapeShape(vertex, shape).Value(), 1e-5);
      }
    }
  }
}

/// Of the body that a closed profile turns, by Green's theorem.
double turned_volume(const std::vector<std::array<double, 2>>& profile) {
  double volume = 0.0;
  for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
    const auto &a = profile[i], &b = profile[i + 1];
    volume += std::numbers::pi / 3.0 * (a[0] * a[0] + a[0] * b[0] + b[0] * b[0]) * (b[1] - a[1]);
  }
  return volume;
}

/// Of the one valid solid that a file holds; 0 where it holds anything else.
double volume_of_step(const std::filesystem::path& file) {
  STEPControl_Reader reader;
  EXPECT_EQ(reader.ReadFile(file.c_str()), IFSelect_RetDone);
  EXPECT_GT(reader.TransferRoots(), 0);
  const TopoDS_Shape shape = reader.OneShape();
  if (shape.IsNull() || shape.ShapeType() != TopAbs_SOLID || !BRepCheck_Analyzer(shape).IsValid()) return 0.0;
  GProp_GProps properties;
  BRepGProp::VolumeProperties(shape, properties);
  return properties.Mass();
}

TEST(StepOpenCascade, ReadsASolidOfTheSameVolume) {
  using Outline = std::vector<std::array<double, 2>>;
  const test::TempDir folder;
  for (const Outline& outline :
       {Outline{{0, 3}, {9, 3}, {9, 5}, {6, 7.6}, {3, 9.1}, {0, 9.6}},
        Outline{{0, 4}, {2, 4}, {2.2, 0.1}, {3, 0.1}, {6, 4}, {9, 9}, {11, 14}, {0, 14}},
        Outline{{5, 0}, {8, 0}, {8, 4}, {5, 4}}}) {
    write_file(folder / "lens.step", solid_step_text(outline, 30.0));
    EXPECT_NEAR(volume_of_step(folder / "lens.step") / turned_volume(solid_profile(outline, 30.0, 1e-4)), 1.0,
                1e-4);
  }
}

// With free forms at the top and at the bottom, against the volume of its triangles.
TEST(StepOpenCascade, ReadsASolidOfTwoFreeFaces) {
  const test::TempDir folder;
  Solid solid;
  solid.outline_mm = {{6, 1}, {6, 0}, {10, 0}, {10, 3}};
  solid.face =
      test::spline_face([](double x, double y) { return 8.0 + 0.01 * x * x - 0.012 * y * y; }, 11.0, 6);
  solid.bottom_face =
      test::spline_face([](double x, double y) { return 2.0 - 0.02 * x * y + 0.005 * x * x; }, 7.0, 4);
  write_file(folder / "lens.step",
             solid_step_text(solid.outline_mm, {*solid.face, solid.bottom_face.get()}, 20.0));
  const auto mesh = surface_mesh(solid, 1e-5);
  double volume = 0.0;
  for (const auto& t : mesh->triangles)
    volume += dot(mesh->vertices_mm[t[0]], cross(mesh->vertices_mm[t[1]], mesh->vertices_mm[t[2]])) / 6.0;
  EXPECT_NEAR(volume_of_step(folder / "lens.step") / volume, 1.0, 1e-4);
}

}  // namespace
}  // namespace lucerna
