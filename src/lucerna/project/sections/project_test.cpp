// SPDX-License-Identifier: Apache-2.0
#include "lucerna/project.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/material.h"
#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/ray_file.h"
#include "tests/support/random_rays.h"
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

// Mirrors that are no height field: an ellipsoid past its equator, a profile that closes in again, by points
// or from a file.
TEST(Project, ProfilesThatAreNoFunctionOfTheRadiusAreCurves) {
  const auto mirror = [](const std::string& keys) {
    return read(reflector("family = 'revolution'\n" + keys)).scene.reflectors[0].reflector;
  };
  const std::string ellipse = "preset = 'ellipse'\nfocal_mm = 5\nfocal2_mm = 65\n";
  const Reflector deep = mirror(ellipse + "mouth_diameter_mm = 30\nhole_diameter_mm = 4\n");
  ASSERT_NE(deep.curve, nullptr);
  EXPECT_EQ(deep.curve->last().r_mm, 15.0);
  EXPECT_GT(deep.curve->last().z_mm, 35.0) << "past the equator";
  EXPECT_EQ(deep.curve->first().r_mm, 2.0);
  EXPECT_EQ(mirror(ellipse + "diameter_mm = 30\n").curve, nullptr);
  const Reflector points = mirror("profile_mm = [[0, 0], [18, 12], [20, 30], [14, 44]]\n");
  ASSERT_NE(points.curve, nullptr);
  EXPECT_GT(points.aperture.half_x_mm(), 19.9) << "the bulge behind the mouth belongs to the mirror";

  const test::TempDir dir;
  write_file(dir / "curve.csv", "r_mm,z_mm\n0,0\n18,12\n20,30\n14,44\n");
  write_file(dir / "p.toml", reflector("family = 'revolution'\nfile = 'curve.csv'\n"));
  const Project project = read_project(dir / "p.toml");
  const Reflector from_file = project.scene.reflectors[0].reflector;
  ASSERT_NE(from_file.curve, nullptr);
  EXPECT_EQ(from_file.curve->at(0.7).r_mm, points.curve->at(0.7).r_mm);
  EXPECT_EQ(project.inputs.size(), 2u);
  EXPECT_NE(project_text(project).find((dir / "curve.csv").string()), std::string::npos);

  const auto expect = [](const std::string& keys, const std::string& part) {
    const std::string found = message(reflector("family = 'revolution'\n" + keys));
    EXPECT_NE(found.find(part), std::string::npos) << found;
  };
  expect(ellipse + "mouth_diameter_mm = 40\n",
         "reflector[0].mouth_diameter_mm: reflector: an ellipse with an "
         "equator of 36.0555 mm");
  expect(ellipse + "mouth_diameter_mm = 30\nhole_diameter_mm = 37\n", "a hole of 37 mm");
  expect(ellipse + "mouth_diameter_mm = 30\ndiameter_mm = 50\n", "reflector[0].diameter_mm: the mirror ends");
  expect(ellipse + "mouth_diameter_mm = 30\naperture = 'rectangle'\n", "a mouth is a circle");
  expect("preset = 'parabola'\nfocal_mm = 5\nmouth_diameter_mm = 30\n", "a parabola does not close in again");
  expect(ellipse + "diameter_mm = 40\n", "or mouth_diameter_mm for a mirror that goes past it");
  expect("file = 'none.csv'\n", "none.csv");
  expect("file = 'none.csv'\nprofile_mm = [[0, 0], [9, 9]]\n", "the reflector has a profile_mm too");
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

constexpr const char* kTetrahedron =
    "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

/// The project of `text` in a folder that holds t.obj, sheet.obj, z.csv and z.pgm.
Project read_with_files(const std::string& text, const test::TempDir& dir) {
  write_file(dir / "t.obj", kTetrahedron);
  write_file(dir / "sheet.obj", "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\n");
  write_file(dir / "z.csv", "8,5,4,5,9\n5,2,1,2,5\n4,1,0,1,4\n5,2,1,2,5\n8,5,4,5,8\n");
  write_file(dir / "z.pgm", "P2 4 4 65535\n0 0 0 0\n0 0 0 0\n0 0 0 0\n0 0 0 40000\n");
  write_file(dir / "p.toml", std::string(kSource) + text);
  return read_project(dir / "p.toml");
}

TEST(Project, BodiesHaveRolesPlacesAndNames) {
  const test::TempDir dir;
  const Project p = read_with_files(
      "[[body]]\nfile = 't.obj'\nposition_mm = [0, 0, -50]\nscale = 2\n"
      "[[body]]\nfile = 't.obj'\nrole = 'mirror'\nreflectance = 0.5\nposition_mm = [0, 0, 90]\n"
      "[[body]]\nfile = 't.obj'\nname = 'bulb'\nrole = 'lamp'\n"
      "[[body]]\nfile = 'sheet.obj'\nopen = true\n"
      "[[reflector]]\nfamily = 'mesh'\nfile = 'sheet.obj'\nreflectance = 0.8\nsmooth_normals = true\n"
      "slope_error_mrad = 3\n",
      dir);
  const std::vector<Body>& b = p.scene.bodies;
  ASSERT_EQ(b.size(), 5u);
  EXPECT_EQ(b[0].name, "sheet") << "mirrors come first";
  EXPECT_EQ(b[0].reflectance.at(1.0), 0.8);
  EXPECT_EQ(b[0].smooth_below_deg, 30.0);
  EXPECT_EQ(b[0].slope_error_mrad, 3.0);
  EXPECT_EQ(b[1].name, "t");
  EXPECT_EQ(b[1].reflectance.at(1.0), 0.0);
  EXPECT_EQ(b[1].mesh->vertices_mm[1], (Vec3{0, 20, 0}));
  EXPECT_EQ(b[1].world_from_body.origin_mm(), (Vec3{0, 0, -50}));
  EXPECT_EQ(b[2].name, "t-2");
  EXPECT_EQ(b[2].reflectance.at(0.3), 0.5);
  EXPECT_EQ(b[3].name, "bulb");
  EXPECT_TRUE(b[3].only_returning_light);
  EXPECT_FALSE(b[2].only_returning_light);
  EXPECT_EQ(b[4].name, "sheet-2");
  EXPECT_EQ(std::count(p.inputs.begin(), p.inputs.end(), dir / "t.obj"), 3);
  EXPECT_NE(project_text(p).find((dir / "sheet.obj").string()), std::string::npos);
}

TEST(Project, CoverGlassIsABodyWithoutAFile) {
  const test::TempDir dir;
  const Project p = read_with_files(
      "[[body]]\nrole = 'glass'\naperture = 'rectangle'\nsize_mm = [80, 60]\nthickness_mm = 4\n"
      "refractive_index = 1.6\nabsorption_per_mm = 0.01\nposition_mm = [0, 0, -20]\n"
      "[[body]]\nrole = 'glass'\ndiameter_mm = 50\nposition_mm = [0, 0, -30]\n",
      dir);
  const std::vector<CoverGlass>& g = p.scene.glasses;
  ASSERT_EQ(g.size(), 2u);
  EXPECT_EQ(g[0].name, "glass");
  EXPECT_EQ(g[0].thickness_mm, 4.0);
  EXPECT_EQ(g[0].refractive_index, 1.6);
  EXPECT_EQ(g[0].absorption_per_mm, 0.01);
  EXPECT_EQ(g[0].world_from_glass.origin_mm(), (Vec3{0, 0, -20}));
  EXPECT_EQ(g[1].name, "glass-2");
  EXPECT_EQ(g[1].refractive_index, CoverGlass{}.refractive_index);
}

TEST(Project, HeightMapsAreScaledPlacedAndClipped) {
  const test::TempDir dir;
  const std::string map =
      "[[reflector]]\nfamily = 'heightmap'\nsize_mm = [80, 40]\nposition_mm = [0, 0, -40]\n";
  const Reflector csv = read_with_files(map + "file = 'z.csv'\nz_scale_mm = 2\nz_offset_mm = 1\n", dir)
                            .scene.reflectors[0]
                            .reflector;
  EXPECT_NEAR(csv.surface->at(40, 20).z_mm, 19.0, 1e-12) << "the first row is at +y";
  EXPECT_NEAR(csv.surface->at(-40, -20).z_mm, 17.0, 1e-12);
  EXPECT_NEAR(csv.surface->at(20, 0).z_mm, 3.0, 1e-12);
  EXPECT_EQ(csv.aperture.half_x_mm(), 40.0);
  const Reflector turned =
      read_with_files(map +
                          "file = 'z.csv'\nfirst_row = 'bottom'\naperture = 'circle'\ndiameter_mm = 30\n"
                          "hole_diameter_mm = 4\n",
                      dir)
          .scene.reflectors[0]
          .reflector;
  EXPECT_NEAR(turned.surface->at(40, -20).z_mm, 9.0, 1e-12);
  EXPECT_EQ(turned.aperture.half_x_mm(), 15.0);
  EXPECT_EQ(turned.aperture.hole_radius_mm(), 2.0);
  const Reflector grey =
      read_with_files(map + "file = 'z.pgm'\nz_scale_mm = 1e-3\n", dir).scene.reflectors[0].reflector;
  EXPECT_NEAR(grey.surface->at(40, -20).z_mm, 40.0, 1e-9) << "a picture's last row is at the bottom";
}

TEST(Project, DetectorsOfAllKindsAtOnce) {
  const Project p = read(
      std::string(kSource) +
      "[[detector]]\nkind = 'far-field'\n[[detector]]\nkind = 'plane'\nposition_mm = [0, 0, -3000]\n"
      "size_mm = [4000, 2000]\ncells = [40, 20]\n[[detector]]\nkind = 'plane'\nname = 'wall'\n"
      "normal = '-x'\nturn_deg = -90\nposition_mm = [1000, 0, 0]\n[[detector]]\nkind = 'luminance'\nfrom "
      "= [0, 3, -4]\n"
      "half_angle_deg = 1\n[[detector]]\nkind = 'luminance'\nname = 'eye'\nfrom_mm = [0, 0, -500]\n"
      "[[detector]]\nkind = 'rays'\nformat = 'zemax-text'\n");
  const Scene& s = p.scene;
  ASSERT_EQ(s.planes.size(), 2u);
  EXPECT_EQ(s.planes[0].grid.world_from_plane, Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -3000}));
  EXPECT_EQ(s.planes[0].grid.nx, 40u);
  EXPECT_EQ(s.planes[0].grid.size_y_mm, 2000.0);
  EXPECT_LT(length(s.planes[1].grid.world_from_plane.ey() - Vec3{0, 0, 1}), 1e-12) << "turned upright";
  EXPECT_EQ(s.planes[1].grid.world_from_plane.ez(), (Vec3{-1, 0, 0}));
  ASSERT_EQ(s.luminances.size(), 2u);
  EXPECT_EQ(s.luminances[0].half_angle_deg, 1.0);
  EXPECT_LT(length(s.luminances[0].grid.world_from_plane.ez() - Vec3{0, 0.6, -0.8}), 1e-15);
  EXPECT_EQ(s.luminances[1].distance_mm, 500.0);
  EXPECT_EQ(s.luminances[1].pupil_radius_mm, 10.0);
  ASSERT_EQ(s.ray_detectors.size(), 1u);
  EXPECT_EQ(s.ray_detectors[0].format, "zemax-text");
}

TEST(Project, ASourceThatReachesThroughTheMirrorIsRefused) {
  const std::string bowl = "family = 'revolution'\npreset = 'parabola'\nfocal_mm = 10\ndiameter_mm = 80\n";
  const auto lamp = [&](const std::string& place, const std::string& keys) {
    return "[[source]]\nkind = 'cylinder'\nradius_mm = 1\nlength_mm = 20\nposition_mm = [0, 0, " + place +
           "]\n[[reflector]]\n" + bowl + keys;
  };
  const std::string fault = message(lamp("5", ""));
  EXPECT_NE(fault.find("source[0]: 2"), std::string::npos) << fault;
  EXPECT_NE(fault.find("start behind reflector[0]: the source reaches through the mirror; expected a "
                       "hole_diameter_mm"),
            std::string::npos)
      << fault;
  EXPECT_EQ(message(lamp("5", "hole_diameter_mm = 3\n")), "") << "the hole lets it through";
  EXPECT_TRUE(read(lamp("15", "")).warnings.empty());
  const Project behind = read(lamp("-30", ""));
  ASSERT_EQ(behind.warnings.size(), 1u) << "wholly behind is odd, but may be meant";
  EXPECT_NE(behind.warnings[0].find("100 % of its rays start behind"), std::string::npos);
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
  expect(reflector(
             "family = 'revolution'\nprofile_mm = [[0, 0], [20, 10], [20, 30], [5, 20], [10, 5], [30, 2]]\n"),
         "reflector[0].profile_mm: reflector: the profile crosses itself: between points");
  expect(reflector("family = 'revolution'\nprofile_mm = [[20, 9], [10, 3], [0, 0]]\ndiameter_mm = 40\n"),
         "from the rim to the axis");
  expect(reflector("family = 'revolution'\nprofile_mm = [[0, 0], [18, 12], [20, 30], [14, 44]]\n"
                   "diameter_mm = 35\n"),
         "would cut it twice; expected the mouth's 28 mm");
  expect(reflector("family = 'faceted'\npitch_mm = 4\nprofile_mm = [[0, 0], [18, 12], [14, 44]]\n"),
         "reflector[0].family: facets need a base that is a function of the radius");
  expect(reflector("family = 'revolution'\n"), "needs a preset or a profile_mm");
  expect(std::string(kSource) + "surface = 'sphere'\n", "surface");
  expect(std::string(kSource) + "surface = 'sphere'\nsurface_mm = 1.0\n", "outside its sphere surface");
  expect(std::string(kSource) + "[[detector]]\nkind = 'far-field'\nc_step_deg = 7\n", "detector[0]");
  expect(std::string(kSource) + "[[detector]]\nkind = 'far-field'\nname = '../x'\n", "no slash");
}

TEST(Project, MetalsAndGlassesHaveTheirMaterials) {
  const std::string mirror = "family = 'revolution'\npreset = 'parabola'\nfocal_mm = 10\ndiameter_mm = 80\n";
  const auto reflectance = [&](const std::string& keys) {
    return read(reflector(mirror + keys)).scene.reflectors[0].reflectance;
  };
  EXPECT_EQ(reflectance("metal = 'silver'\n").at(0.5), metal_reflectance("silver", 555.0).at(0.5));
  EXPECT_EQ(reflectance("metal = 'aluminium'\nwavelength_nm = 700\n").at(1.0),
            metal_reflectance("aluminium", 700.0).at(1.0));
  const std::string glass = std::string(kSource) + "[[body]]\nrole = 'glass'\ndiameter_mm = 9\n";
  EXPECT_EQ(read(glass + "material = 'bk7'\nwavelength_nm = 650\n").scene.glasses[0].refractive_index,
            refractive_index("bk7", 650.0).n);

  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_THAT(message(text), testing::HasSubstr(part));
  };
  expect(reflector(mirror + "metal = 'aluminum'\n"), "reflector[0].metal: found 'aluminum'");
  expect(reflector(mirror + "metal = 'silver'\nreflectance = 0.9\n"),
         "reflector[0].reflectance: found `metal`");
  expect(reflector(mirror + "wavelength_nm = 600\n"), "belongs to `metal`");
  expect(reflector(mirror + "metal = 'silver'\nwavelength_nm = 900\n"), "expected 380 to 780");
  expect(glass + "material = 'silver'\n", "body[0].material: found 'silver'");
  expect(glass + "material = 'pmma'\nrefractive_index = 1.5\n", "body[0].refractive_index: found `material`");
  expect(glass + "material = 'pmma'\nwavelength_nm = 400\n", "expected 420 to 1620 nm");
  expect(glass + "wavelength_nm = 600\n", "belongs to `material`");
  expect(glass + "metal = 'silver'\n", "body[0].metal: has a meaning only with other keys");
}

// A made-up catalogue; the dispersion of its glass is that of bk7.
const char* const kCatalogue =
    "NM CROWN-7 2 517642 1.5168 64.17\n"
    "CD 1.03961212 0.00600069867 0.231792344 0.0200179144 1.01046945 103.560653\n"
    "LD 0.3 2.5\nIT 0.4 0.9 10\nIT 0.8 0.9 10\n";

TEST(Project, GlassesOfACatalogueHaveItsIndexAndAbsorption) {
  const test::TempDir dir;
  write_file(dir / "made.agf", kCatalogue);
  const auto read_from = [&](const std::string& keys) {
    write_file(dir / "p.toml", kSource + ("[[body]]\nrole = 'glass'\ndiameter_mm = 9\n" + keys));
    return read_project(dir / "p.toml");
  };
  const std::string glass = "catalogue = 'made.agf'\nglass = 'crown-7'\n";
  const Project project = read_from(glass);
  EXPECT_NEAR(project.scene.glasses.at(0).refractive_index, refractive_index("bk7", 555.0).n, 1e-9);
  EXPECT_NEAR(project.scene.glasses.at(0).absorption_per_mm, -std::log(0.9) / 10.0, 1e-12);
  EXPECT_EQ(project.inputs.back(), dir / "made.agf") << "its bytes are part of what was traced";
  const Scene other = read_from(glass + "wavelength_nm = 2000\nabsorption_per_mm = 0.001\n").scene;
  EXPECT_NEAR(other.glasses.at(0).refractive_index, refractive_index("bk7", 2000.0).n, 1e-9);
  EXPECT_EQ(other.glasses.at(0).absorption_per_mm, 0.001);

  const auto expect = [&](const std::string& keys, const std::string& part) {
    try {
      (void)read_from(keys);
      ADD_FAILURE() << keys;
    } catch (const InputError& e) {
      EXPECT_THAT(e.what(), testing::HasSubstr(part)) << keys;
    }
  };
  expect(glass + "wavelength_nm = 900\n", "body[0].wavelength_nm: transmittance of glass 'CROWN-7'");
  expect(glass + "wavelength_nm = 4000\nabsorption_per_mm = 0\n", "formula of glass 'CROWN-7'");
  expect(glass + "material = 'bk7'\n", "body[0].catalogue: found `material` too");
  expect(glass + "refractive_index = 1.5\n", "body[0].refractive_index: found `catalogue` too");
  expect("catalogue = 'made.agf'\n", "body[0].glass: is missing");
  expect("glass = 'CROWN-7'\n", "body[0].glass: belongs to `catalogue`");
  expect("catalogue = 'made.agf'\nglass = 'CROWN-8'\n", "the nearest of 1 is 'CROWN-7'");
  expect("catalogue = 'absent.agf'\nglass = 'CROWN-7'\n", "absent.agf");
}

TEST(Project, SolidsAreMeshesOrOutlinesOfAMedium) {
  const std::string lens = std::string(kSource) + "[[body]]\nrole = 'solid'\n";
  const std::string outline = "outline_mm = [[0, 0], [5, 0], [5, 2], [0, 4]]\n";
  const Scene scene =
      read(lens + outline + "material = 'pmma'\nabsorption_per_mm = 0.01\n" +
           "smooth_below_deg = 5\nposition_mm = [0, 0, 7]\n[[body]]\nrole = 'solid'\n" + outline)
          .scene;
  ASSERT_EQ(scene.solids.size(), 2U);
  EXPECT_EQ(scene.solids[0].name, "solid");
  EXPECT_EQ(scene.solids[1].name, "solid-2");
  EXPECT_EQ(scene.solids[0].refractive_index, refractive_index("pmma", 555.0).n);
  EXPECT_EQ(scene.solids[0].absorption_per_mm, 0.01);
  EXPECT_EQ(scene.solids[0].smooth_below_deg, 5.0);
  EXPECT_EQ(scene.solids[0].world_from_solid.origin_mm(), (Vec3{0, 0, 7}));
  EXPECT_EQ(scene.solids[1].refractive_index, Solid().refractive_index);
  EXPECT_EQ(scene.solids[1].outline_mm.size(), 4U);
  EXPECT_EQ(open_edges(*surface_mesh(scene.solids[1])), 0U);

  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_THAT(message(text), testing::HasSubstr(part));
  };
  expect(lens, "body[0].file");
  expect(lens + outline + "file = 'lens.stl'\n", "body[0].file: found `outline_mm` too");
  expect(lens + "outline_mm = [[0, 0], [5, 0]]\n", "body[0].outline_mm: outline of 2 corners");
  expect(lens + outline + "refractive_index = 5\n", "body[0].refractive_index");
  expect(lens + outline + "thickness_mm = 5\n", "body[0].thickness_mm");
  expect(std::string(kSource) + "[[body]]\nrole = 'absorber'\n" + outline, "body[0]");
}

TEST(Project, ASolidHasAFreeFace) {
  const std::string lens = std::string(kSource) + "[[body]]\nrole = 'solid'\n";
  const std::string outline = "outline_mm = [[0, 0], [10, 0], [10, 2]]\n";
  std::string heights;  // 5 everywhere but for one coefficient
  for (int i = 0; i < 20; ++i) heights += i == 7 ? "5.3, " : "5, ";
  const std::string coefficients = "coefficients_mm = [" + heights + "]\n";
  const std::string face = "[body.face]\nhalf_mm = 11\nintervals = [1, 2]\n" + coefficients;
  const Project project = read(lens + outline + face);
  ASSERT_EQ(project.scene.solids.size(), 1U);
  const Solid& solid = project.scene.solids[0];
  ASSERT_NE(solid.face, nullptr);
  EXPECT_NEAR(solid.face->at(-11.0, 11.0).z_mm, 5.0, 1e-12) << "no paraboloid below it";
  EXPECT_GT(solid.face->at(11.0, -11.0).z_mm, solid.face->at(-11.0, -11.0).z_mm) << "x comes first";
  EXPECT_EQ(open_edges(*surface_mesh(solid)), 0U);
  EXPECT_EQ(solid.outline_mm.size(), 3U);
  const Project again = read(project_text(project));
  EXPECT_EQ(project_text(again), project_text(project));
  for (const double x : {-7.3, 0.1, 4.0})
    EXPECT_EQ(again.scene.solids[0].face->at(x, 2.5).z_mm, solid.face->at(x, 2.5).z_mm);

  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_THAT(message(text), testing::HasSubstr(part));
  };
  expect(lens + "file = 'lens.stl'\n" + face, "body[0].face: belongs to `outline_mm`");
  expect(lens + outline + "[body.face]\nintervals = [1, 2]\n" + coefficients, "body[0].face.half_mm");
  expect(lens + outline + "[body.face]\nhalf_mm = 11\n" + coefficients, "body[0].face.intervals");
  expect(lens + outline + "[body.face]\nhalf_mm = 11\nintervals = [1, 2]\n", "body[0].face.coefficients_mm");
  expect(lens + outline + "[body.face]\nhalf_mm = 9\nintervals = [1, 2]\n" + coefficients,
         "body[0].face.half_mm: found 9, expected at least the wall's radius, 10");
  expect(lens + outline + "[body.face]\nhalf_mm = 11\nintervals = [2, 2]\n" + coefficients,
         "body[0].face.coefficients_mm");
  std::string steep = coefficients;
  steep.replace(steep.find("5.3"), 3, "-11001");
  expect(lens + outline + "[body.face]\nhalf_mm = 11\nintervals = [1, 2]\n" + steep,
         "body[0].face.coefficients_mm: found -11001, expected at most 11000 mm");
  expect(lens + outline + face + "focal_mm = 3\n", "body[0].face.focal_mm: unknown key");
  expect(lens + "outline_mm = [[0, 0], [10, 0], [10, 2], [0, 4]]\n" + face,
         "body[0].face: solid 'solid': outline below a face: found its last side");
  expect(lens + "outline_mm = [[0, 6], [4, 0], [10, 0], [10, 2]]\n" + face,
         "body[0].face: solid 'solid': face: found z = 5");
}

TEST(Project, ASolidHasLensletsOnIt) {
  const std::string lens = std::string(kSource) + "[[body]]\nrole = 'solid'\n";
  const std::string outline = "outline_mm = [[0, 0], [10, 0], [10, 1]]\n";
  const std::string array = "[body.array]\npitch_mm = 1.5\nradius_mm = 2\napex_mm = 3\n";
  const Solid solid = read(lens + outline + array).scene.solids.at(0);
  ASSERT_NE(solid.face, nullptr);
  EXPECT_EQ(solid.face->at(3.0, -1.5).z_mm, 3.0);
  EXPECT_NEAR(solid.face->at(0.5, 0.0).z_mm, 1.0 + std::sqrt(4.0 - 0.25), 1e-12);
  const Solid other = read(lens + outline + array + "layout = 'hexagonal'\nconic = -1\n").scene.solids.at(0);
  EXPECT_NEAR(other.face->at(0.75, 1.5 * std::sqrt(0.75)).z_mm, 3.0, 1e-12);

  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_THAT(message(text), testing::HasSubstr(part));
  };
  expect(lens + array, "body[0].array: belongs to `outline_mm`");
  expect(lens + outline + "[body.array]\nradius_mm = 2\napex_mm = 3\n", "body[0].array.pitch_mm");
  expect(lens + outline + array + "layout = 'hex'\n", "expected square or hexagonal");
  expect(lens + outline + "[body.array]\npitch_mm = 5\nradius_mm = 2\napex_mm = 3\n",
         "body[0].array.radius_mm: array: lenslets of radius_mm = 2");
  expect(lens + "outline_mm = [[0, 4], [10, 0], [10, 2.9]]\n" + array,
         "body[0].array: solid 'solid': array: found lenslets that reach down to z = 2.695");
}

TEST(Project, AMisspeltKeyIsNamedWhereItsMeaningIsMissing) {
  const test::TempDir dir;
  const auto message = [&](const std::string& reflector) {
    return test::message_of<InputError>([&] { read_with_files("[[reflector]]\n" + reflector, dir); });
  };
  const std::string rest = "preset = 'parabola'\ndiameter_mm = 80\n";
  const std::string family = "family = 'revolution'\n" + rest;
  for (const std::string typed : {"famly", "fammily", "familg", "afmily"}) {
    EXPECT_THAT(message(typed + " = 'revolution'\n" + rest),
                testing::HasSubstr("line 6: reflector[0]." + typed +
                                   ": unknown key; the nearest known one is 'family', which is missing"));
  }
  EXPECT_THAT(message(family + "focal_m = 15\n"), testing::HasSubstr("reflector[0].focal_m: unknown key"));
  // Too far from what is missing to be meant, or a key that is known.
  EXPECT_THAT(message(family + "focus = 15\n"), testing::HasSubstr("reflector[0].focal_mm: is missing"));
  EXPECT_THAT(message(family + "focal2_mm = 15\n"), testing::HasSubstr("reflector[0].focal_mm: is missing"));
}

TEST(Project, BadBodiesMapsAndDetectorsNameTheirKey) {
  const test::TempDir dir;
  const auto expect = [&](const std::string& text, const std::string& part) {
    const std::string found = test::message_of<InputError>([&] { read_with_files(text, dir); });
    EXPECT_NE(found.find(part), std::string::npos) << found;
    EXPECT_EQ(found.find('\n'), std::string::npos);
  };
  expect("[[body]]\n", "line 5: body[0].file: is missing");
  expect("[[body]]\nfile = 'sheet.obj'\n", "the mesh is open: 3 edges");
  expect("[[body]]\nfile = 't.obj'\nrole = 'shade'\n", "found 'shade', expected absorber");
  expect("[[body]]\nrole = 'glass'\n", "diameter_mm");
  expect("[[body]]\nrole = 'glass'\ndiameter_mm = 9\nrefractive_index = 0.5\n", "0.5");
  expect("[[body]]\nrole = 'glass'\nfile = 't.obj'\ndiameter_mm = 9\n", "file");
  expect("[[body]]\nfile = 't.obj'\nreflectance = 0.5\n", "belongs to role = \"mirror\"");
  expect("[[body]]\nfile = 't.obj'\nrole = 'mirror'\nreflectance = -0.1\n", "outside 0..1");
  expect("[[body]]\nfile = 't.obj'\nrol = 'mirror'\n", "nearest known one is 'role'");
  expect("[[body]]\nfile = 't.step'\n", "t.step");
  expect("[[body]]\nfile = 't.obj'\nname = 'x'\n[[body]]\nfile = 't.obj'\nname = 'x'\n", "named 'x'");
  const std::string mesh = "[[reflector]]\nfamily = 'mesh'\nfile = 't.obj'\n";
  expect(mesh + "crease_deg = 20\n", "needs smooth_normals");
  expect(mesh + "slope_error_mrad = -1\n", "slope_error_mrad: found -1, expected 0 to 1000");
  expect("[[body]]\nfile = 't.obj'\nslope_error_mrad = 2\n",
         "belongs to role = \"mirror\"; this is absorber");
  expect(mesh + "smooth_normals = true\ncrease_deg = 200\n", "expected > 0 and <= 180");
  const std::string map = "[[reflector]]\nfamily = 'heightmap'\n";
  expect(map + "size_mm = [1, 1]\n", "reflector[0].file: is missing");
  expect(map + "file = 'z.csv'\n", "size_mm: is missing");
  expect(map + "file = 'z.csv'\nsize_mm = [1, 0]\n", "found 0, expected > 0");
  expect(map + "file = 'z.pgm'\nsize_mm = [9, 9]\n", "z_scale_mm: is missing");
  expect(map + "file = 'z.csv'\nsize_mm = [9, 9]\nfirst_row = 'left'\n", "expected top or bottom");
  expect(map + "file = 'z.csv'\nsize_mm = [9, 9]\naperture = 'circle'\ndiameter_mm = 10\n", "reach 9 mm");
  expect(map + "file = 'z.csv'\nsize_mm = [9, 9]\nhole_diameter_mm = 10\n", "hole");
  const std::string detector = "[[detector]]\nkind = ";
  expect(detector + "'eye'\n", "expected far-field, plane, luminance or rays");
  expect(detector + "'plane'\nsize_mm = [1, -1]\n", "found -1, expected > 0");
  expect(detector + "'plane'\ncells = [1, 1.5]\n", "expected a whole number");
  expect(detector + "'plane'\ncells = [10000, 10000]\n", "cells");
  expect(detector + "'plane'\nnormal = [0, 0, 0]\n", "zero vector");
  expect(detector + "'luminance'\n", "from: is missing");
  expect(detector + "'luminance'\nfrom = '+x'\nfrom_mm = [1, 0, 0]\n", "a direction (from) or from a point");
  expect(detector + "'luminance'\nfrom_mm = [0, 0, 0]\n", "the observer is at position_mm");
  expect(detector + "'luminance'\nfrom = '+x'\nhalf_angle_deg = 90\n", "expected > 0 and < 90");
  expect(detector + "'rays'\nformat = 'tm26'\n", "found 'tm26', expected tm25, zemax-binary");
  expect(detector + "'plane'\nname = 'x'\n[[detector]]\nkind = 'rays'\nname = 'x'\n",
         "two detectors are named 'x'");
}

}  // namespace
}  // namespace lucerna
