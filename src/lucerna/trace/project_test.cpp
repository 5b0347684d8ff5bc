// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/project.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/rayset/ray_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

Project read(const std::string& text) {
  const test::TempDir dir;
  write_file(dir / "p.toml", text);
  return read_project(dir / "p.toml");
}

std::string message(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

constexpr const char* kSource = "[[source]]\nkind = 'disk'\nradius_mm = 2\nflux_lm = 50\n";

std::string reflector(const std::string& keys) { return std::string(kSource) + "[[reflector]]\n" + keys; }

TEST(Project, TemplateReadsAndPutsTheFocusAtTheSource) {
  const Project project = read(project_template());
  ASSERT_EQ(project.scene.sources.size(), 1u);
  ASSERT_EQ(project.scene.reflectors.size(), 1u);
  EXPECT_EQ(project.scene.sources[0].total_flux(), 1000.0);
  const Frame& frame = project.scene.reflectors[0].world_from_reflector;
  EXPECT_LT(length(frame.point({0, 0, 15})), 1e-12);
  EXPECT_EQ(project.scene.far_fields[0].name, "far");
}

TEST(Project, WithoutADetectorThereIsAFarField) {
  const Project project = read(kSource);
  ASSERT_EQ(project.scene.far_fields.size(), 1u);
  EXPECT_EQ(project.scene.far_fields[0].name, "far-field");
  EXPECT_EQ(project.scene.far_fields[0].c_step_deg, 5.0);
}

TEST(Project, SourcesArePlacedAndOverridden) {
  const test::TempDir dir;
  RaySet set;
  set.header.flux_lm = 10.0;
  set.rays.resize(3, 0);
  for (std::size_t i = 0; i < 3; ++i) {
    set.rays.set(i, {{0, 0, 0}, Direction()});
    set.rays.weight[i] = 1.0f;
  }
  write_ray_set(dir / "s.tm25ray", set, "tm25");
  write_file(dir / "p.toml",
             "[[source]]\nfile = 's.tm25ray'\nflux_lm = 337\naxis = '-x'\nposition_mm = [1, 2, 3]\n" +
                 std::string(kSource));
  const Project project = read_project(dir / "p.toml");
  EXPECT_EQ(project.scene.sources[0].total_flux(), 337.0);
  EXPECT_EQ(project.scene.sources[0].rays->ray_count(), 3u);
  const Frame& frame = project.scene.sources[0].world_from_source;
  EXPECT_LT(length(frame.ez() - Vec3{-1, 0, 0}), 1e-15);
  EXPECT_EQ(frame.origin_mm(), (Vec3{1, 2, 3}));
  ASSERT_EQ(project.inputs.size(), 2u);
  // The project that is written elsewhere still finds its ray file.
  EXPECT_NE(project_text(project).find((dir / "s.tm25ray").string()), std::string::npos);
}

TEST(Project, FamiliesBuildTheirMirrors) {
  const Project parabola =
      read(reflector("family = 'revolution'\npreset = 'parabola'\nfocal_mm = 10\ndiameter_mm = 80\n"));
  EXPECT_NEAR(parabola.scene.reflectors[0].reflector.surface->at(20.0, 0.0).z_mm, 10.0, 1e-12);
  const Project spline =
      read(reflector("family = 'revolution'\nprofile_mm = [[0, 0], [20, 10], [40, 40]]\n"));
  EXPECT_NEAR(spline.scene.reflectors[0].reflector.surface->at(0.0, 40.0).z_mm, 40.0, 1e-9);
  EXPECT_EQ(spline.scene.reflectors[0].reflector.aperture.half_x_mm(), 40.0);
}

TEST(Project, TroughsFacetsAndTheirSurfacesAreRead) {
  const std::string parabola = "preset = 'parabola'\nfocal_mm = 10\ndiameter_mm = 80\n";
  const auto mirror = [&](const std::string& keys) {
    return read(reflector(keys + parabola)).scene.reflectors[0];
  };
  const PlacedReflector trough = mirror("family = 'trough'\nslope_error_mrad = 2\n");
  EXPECT_NEAR(trough.reflector.surface->at(20.0, 33.0).z_mm, 10.0, 1e-12);
  EXPECT_EQ(trough.slope_error_mrad, 2.0);
  const PlacedReflector facets =
      mirror("family = 'faceted'\npitch_mm = 8\nreflectance = [[0, 0.8], [60, 0.6]]\n");
  const SurfacePoint here = facets.reflector.surface->at(20.5, 0.5),
                     there = facets.reflector.surface->at(21.0, 0.5);
  EXPECT_EQ(here.dzdx, there.dzdx) << "a flat facet has one slope";
  EXPECT_NEAR(facets.reflectance.at(std::cos(radians(30.0))), 0.7, 1e-12);
}

TEST(Project, BadMirrorsNameTheirKey) {
  const std::string parabola = "family = 'revolution'\npreset = 'parabola'\n";
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(message(text).find(part), std::string::npos) << message(text);
  };
  expect(reflector("family = 'mirror'\n"), "reflector[0].family: found 'mirror'");
  expect(reflector(parabola + "diameter_mm = 80\n"), "focal_mm: is missing");
  expect(reflector(parabola + "focal_mm = 10\n"), "diameter_mm: is missing");
  expect(reflector(parabola + "focal_mm = 10\ndiameter_mm = 80\nhole_diameter_mm = 90\n"), "hole");
  expect(reflector(parabola + "focal_mm = 10\ndiameter_mm = 80\nreflectance = 1.2\n"),
         "reflector[0].reflectance");
  expect(reflector(parabola + "focal_mm = 10\nfocal2_mm = 10\ndiameter_mm = 80\n"),
         "a parabola has one focus");
  expect(reflector("family = 'revolution'\nprofile_mm = [[0, 0], [20, 10], [15, 40]]\n"), "profile_mm");
  expect(reflector("family = 'revolution'\n"), "needs a preset or a profile_mm");
  expect(std::string(kSource) + "surface = 'sphere'\n", "surface");
  expect(std::string(kSource) + "surface = 'sphere'\nsurface_mm = 1.0\n", "outside its sphere surface");
  expect(std::string(kSource) + "[[detector]]\nkind = 'far-field'\nc_step_deg = 7\n", "detector[0]");
  expect(std::string(kSource) + "[[detector]]\nkind = 'far-field'\nname = '../x'\n", "no slash");
}

}  // namespace
}  // namespace lucerna
