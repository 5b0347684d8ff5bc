// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/project.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr const char* kMirror =
    "[[source]]\nkind = 'disk'\nradius_mm = 2\nflux_lm = 50\n"
    "[[reflector]]\nfamily = 'revolution'\npreset = 'parabola'\nfocal_mm = 10\ndiameter_mm = 80\nposition_mm "
    "= [0, 0, -10]\n";

Project read_mirror(const std::string& keys) {
  const test::TempDir dir;
  write_file(dir / "p.toml", kMirror + keys);
  return read_project(dir / "p.toml");
}

std::string mirror_fault(const std::string& keys) {
  try {
    read_mirror(keys);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

std::string lobe(const std::string& keys) { return "[[reflector.scatter]]\n" + keys; }

TEST(ProjectSurface, LobesAreReadInOrder) {
  const Project p = read_mirror("reflectance = 0.8\n" + lobe("model = 'lambert'\nshare = 0.1\n") +
                                lobe("model = 'gaussian'\nshare = 0.2\nsigma = 0.05\n") +
                                lobe("model = 'abg'\na = 0.01\nb = 1e-4\ng = 2\n"));
  const PlacedReflector& mirror = p.scene.reflectors[0];
  EXPECT_EQ(mirror.reflectance.at(1.0), 0.8);
  const auto& lobes = mirror.scatter.lobes();
  ASSERT_EQ(lobes.size(), 3u);
  EXPECT_EQ(lobes[0].kind, ScatterKind::lambert);
  EXPECT_EQ(lobes[1].sigma, 0.05);
  EXPECT_EQ(lobes[2].kind, ScatterKind::abg);
  EXPECT_TRUE(p.warnings.empty());
  EXPECT_TRUE(read_mirror("").scene.reflectors[0].scatter.empty());
}

TEST(ProjectSurface, ADataSheetSaysWhatWasAssumed) {
  const Project p = read_mirror("[reflector.data_sheet]\ntotal = 0.8\ndiffuse = 0.2\ngloss_60 = 400\n");
  const PlacedReflector& mirror = p.scene.reflectors[0];
  EXPECT_EQ(mirror.reflectance.at(1.0), 0.8);
  ASSERT_EQ(mirror.scatter.lobes().size(), 2u);
  EXPECT_NEAR(mirror.scatter.lobes()[0].share, 0.25, 1e-12);
  ASSERT_EQ(p.warnings.size(), 1u);
  EXPECT_THAT(p.warnings[0],
              AllOf(HasSubstr("reflector[0].data_sheet: assumed"), HasSubstr("25 % of the returned light"),
                    HasSubstr("75 % in a Gaussian lobe"), HasSubstr("nothing mirrored")));
}

TEST(ProjectSurface, BadKeysAreNamed) {
  EXPECT_THAT(mirror_fault(lobe("share = 0.1\n")), HasSubstr("reflector[0].scatter[0].model"));
  EXPECT_THAT(mirror_fault(lobe("model = 'phong'\n")), HasSubstr("expected lambert, gaussian or abg"));
  EXPECT_THAT(mirror_fault(lobe("model = 'gaussian'\nshare = 0.1\n")), HasSubstr("sigma"));
  EXPECT_THAT(mirror_fault(lobe("model = 'abg'\nshare = 0.1\na = 0.01\nb = 1e-3\ng = 2\n")),
              HasSubstr("share: belongs to lambert and gaussian"));
  EXPECT_THAT(mirror_fault(lobe("model = 'lambert'\nshare = 0.1\ng = 2\n")), HasSubstr("g: belongs to abg"));
  EXPECT_THAT(mirror_fault(lobe("model = 'lambert'\nshare = 0.1\nsigma = 0.1\n")),
              HasSubstr("sigma: belongs to gaussian; this is lambert"));
  EXPECT_THAT(mirror_fault(lobe("model = 'abg'\na = 1\nb = 1e-6\ng = 2\n")), HasSubstr("times the light"));
  EXPECT_THAT(
      mirror_fault(lobe("model = 'lambert'\nshare = 0.6\n") + lobe("model = 'lambert'\nshare = 0.6\n")),
      HasSubstr("shares add up to 1.2"));
  const std::string sheet = "[reflector.data_sheet]\ntotal = 0.8\ndiffuse = 0.2\n";
  EXPECT_THAT(mirror_fault("reflectance = 0.9\n" + sheet), HasSubstr("found `data_sheet` too"));
  EXPECT_THAT(mirror_fault(sheet + "gloss_60 = 900\n"), HasSubstr("gloss_60"));
  EXPECT_THAT(mirror_fault("[reflector.data_sheet]\ntotal = 0.8\n"), HasSubstr("diffuse"));
}

constexpr const char* kBsdf =
    "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n"
    "SampleRotation 1\n0\nAngleOfIncidence 2\n0 60\nScatterAzimuth 2\n0 180\nScatterRadial 3\n0 10 90\n"
    "Monochrome\nDataBegin\nTIS 0.8\n5 0.1 0\n5 0.1 0\nTIS 0.3\n9 0.2 0.1\n9 0.2 0\nDataEnd\n";

TEST(ProjectSurface, AMeasuredTableHasItsReflectance) {
  const test::TempDir dir;
  write_file(dir / "sheet.bsdf", kBsdf);
  const auto read = [&](const std::string& keys) {
    write_file(dir / "p.toml", kMirror + keys);
    return read_project(dir / "p.toml");
  };
  const Project p = read("bsdf = 'sheet.bsdf'\n");
  const PlacedReflector& mirror = p.scene.reflectors[0];
  ASSERT_NE(mirror.scatter.measured(), nullptr);
  EXPECT_NEAR(mirror.reflectance.at(1.0), 0.8, 1e-12);
  EXPECT_NEAR(mirror.reflectance.at(0.5), 0.3, 1e-12);
  ASSERT_EQ(p.warnings.size(), 2u);
  EXPECT_THAT(p.warnings[0],
              AllOf(HasSubstr("states a reflectance of 0.8 at 0 degrees"), HasSubstr("add up to")));
  EXPECT_THAT(p.inputs, testing::Contains(std::filesystem::absolute(dir / "sheet.bsdf")));
  EXPECT_THROW(read("bsdf = 'sheet.bsdf'\nreflectance = 0.5\n"), InputError);
  EXPECT_THROW(read("bsdf = 'none.bsdf'\n"), InputError);
}

std::string solid(const std::string& keys) {
  return "[[source]]\nkind = 'disk'\nradius_mm = 2\n[[body]]\nrole = 'solid'\nname = 'lens'\nposition_mm = "
         "[0, 0, "
         "5]\n" +
         keys;
}

TEST(ProjectSurface, SidesOfASolidScatter) {
  const std::string outline = "outline_mm = [[0, 0], [10, 0], [10, 2], [0, 2]]\n";
  const std::string lobes = "[[body.scatter]]\nmodel = 'gaussian'\nshare = 0.2\nsigma = 0.05\n";
  const auto read_solid = [](const std::string& keys) {
    return parse_project(solid(keys), "p.toml", {}).scene.solids.at(0);
  };
  const Solid some = read_solid(outline + "scatter_sides = [2, 1]\n" + lobes);
  EXPECT_EQ(some.scatter.lobes().size(), 1u);
  EXPECT_EQ(some.scatter_sides, (std::vector<std::size_t>{2, 1}));
  EXPECT_TRUE(read_solid(outline + lobes).scatter_sides.empty());
  const auto fault = [&](const std::string& keys) -> std::string {
    try {
      read_solid(keys);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  };
  EXPECT_THAT(fault(outline + "scatter_sides = 1\n"), HasSubstr("belongs to `scatter`"));
  EXPECT_THAT(fault(outline + "scatter_sides = []\n" + lobes), HasSubstr("found an empty list"));
  EXPECT_THAT(fault(outline + "scatter_sides = 4\n" + lobes),
              AllOf(HasSubstr("scatter_sides"), HasSubstr("side 4 of an outline of 4 sides")));
  EXPECT_THAT(fault(outline + "data_sheet = { total = 0.8, diffuse = 0.1 }\n"), HasSubstr("data_sheet"));
}

// A designed project and one written elsewhere are read again.
TEST(ProjectSurface, TheTextOfAProjectKeepsItsLobes) {
  const Project p = read_mirror(lobe("model = 'gaussian'\nshare = 0.2\nsigma = 0.05\n"));
  const test::TempDir dir;
  write_file(dir / "again.toml", project_text(p));
  const Project again = read_project(dir / "again.toml");
  const auto& lobes = again.scene.reflectors[0].scatter.lobes();
  ASSERT_EQ(lobes.size(), 1u);
  EXPECT_EQ(lobes[0].sigma, 0.05);
}

TEST(ProjectSurface, OfATableOfSeveralWavelengthsTheNearestIsTaken) {
  const test::TempDir dir;
  std::string table =
      "Symmetry Asymmetric\nSpectralContent Monochrome\nScatterAzimuth 1\n0\nScatterRadial 2\n0 90\n"
      "DataBegin\n";
  for (const char* nm : {"450", "650"})
    table += std::string("AOI 0\nWavelength ") + nm + "\nScatterType BRDF\nTIS 0." + nm + "\n1 1\n";
  write_file(dir / "sheet.bsdf", table + "DataEnd\n");
  const auto at = [&](const std::string& keys) {
    write_file(dir / "p.toml",
               "[[source]]\nkind = 'disk'\n[[reflector]]\nfamily = 'revolution'\npreset = "
               "'parabola'\nfocal_mm = 10\n"
               "diameter_mm = 80\nposition_mm = [0, 0, 10]\naxis = '-z'\nbsdf = 'sheet.bsdf'\n" +
                   keys);
    return read_project(dir / "p.toml").scene.reflectors.at(0).reflectance.at(1.0);
  };
  EXPECT_NEAR(at(""), 0.65, 1e-12) << "555 nm";
  EXPECT_NEAR(at("wavelength_nm = 540\n"), 0.45, 1e-12);
}

}  // namespace
}  // namespace lucerna
