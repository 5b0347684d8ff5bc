// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/target_zone.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design_problem.h"
#include "lucerna/photometric_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

using test::TempDir;
using testing::HasSubstr;

constexpr const char* kZoneFreeForm = R"(
[[source]]
kind = "disk"
radius_mm = 1.0
flux_lm = 500
[[reflector]]
family = "bspline"
focal_mm = 8
diameter_mm = 60.0
position_mm = [0, 0, 8]
axis = "-z"
)";

DesignProblem problem(const TempDir& folder, const std::string& target,
                      const std::string& scene = kZoneFreeForm) {
  write_file(folder / "p.toml", scene + ("[target]\n" + target));
  return design_problem(read_project(folder / "p.toml"), folder / "p.toml");
}

std::string error_of(const std::string& target, const std::string& scene = kZoneFreeForm) {
  const TempDir folder;
  try {
    problem(folder, target, scene);
  } catch (const InputError& e) {
    return e.what();
  }
  return "no error";
}

constexpr const char* kZoneFloor =
    "kind = \"plane\"\nposition_mm = [0, 0, -1500]\nnormal = \"+z\"\nsize_mm = [800, 500]\n";

TEST(TargetZone, ReadsRegionsAndBounds) {
  const TempDir folder;
  const DesignProblem p = problem(folder, R"(axis = "-z"
[[target.zone]]
name = "centre"
gamma_deg = 0
c_deg = 0
min_cd_per_klm = 100
max_cd = 90
[[target.zone]]
h_deg = [-20, 20]
v_deg = [-5, 10]
cell_deg = 2.5
min_of_mean = 0.5
mean_of = "centre"
)");
  ASSERT_TRUE(p.target.zones);
  EXPECT_TRUE(p.target.zones_only);
  const TargetZone &a = p.target.zones->zones()[0], &b = p.target.zones->zones()[1];
  EXPECT_EQ(a.name, "centre");
  EXPECT_EQ(a.coordinates, ZoneCoordinates::gamma_c);
  ASSERT_EQ(a.bounds.size(), 2u);
  EXPECT_EQ(a.bounds[1].key, "min_cd_per_klm");
  EXPECT_DOUBLE_EQ(a.bounds[1].value, 50.0);  // of 500 lm
  EXPECT_DOUBLE_EQ(a.bounds[0].value, 90.0);
  EXPECT_FALSE(a.bounds[0].is_min);
  EXPECT_EQ(b.name, "zone 2");
  EXPECT_EQ(b.coordinates, ZoneCoordinates::h_v);
  EXPECT_EQ(b.row, (ZoneRange{-5.0, 10.0}));
  EXPECT_EQ(b.column, (ZoneRange{-20.0, 20.0}));
  EXPECT_DOUBLE_EQ(b.cell, 2.5);
  EXPECT_EQ(b.bounds[0].reference, ZoneReference::mean);
  EXPECT_EQ(b.bounds[0].mean_of, 0u);
}

TEST(TargetZone, ReadsUniformityOnAPlane) {
  const TempDir folder;
  const DesignProblem p = problem(folder, std::string(kZoneFloor) + R"([[target.zone]]
name = "lane"
x_mm = [-300, 300]
y_mm = 50
cell_mm = 20
min_lx = 10
min_ul = 0.6
[[target.zone]]
x_mm = [-400, 400]
y_mm = [-200, 200]
min_uo = 0.4
)");
  const std::vector<TargetZone>& zones = p.target.zones->zones();
  EXPECT_EQ(zones[0].bounds[1].reference, ZoneReference::brightest);
  EXPECT_EQ(zones[1].bounds[0].reference, ZoneReference::mean);
  EXPECT_EQ(zones[1].bounds[0].mean_of, 1u);
  EXPECT_DOUBLE_EQ(zones[1].cell, 40.0);  // a tenth of the shorter side
}

TEST(TargetZone, StandsBesideAFile) {
  const TempDir folder;
  PhotometricFile spot;
  spot.distribution = uniform_distribution(0.0, 1.0);
  for (std::size_t g = 0; g < 40; ++g) spot.distribution.at(0, g) = 100.0;
  write_photometric_file(folder / "spot.ldt", spot, PhotometricFormat::ldt);
  const DesignProblem p = problem(
      folder, "file = \"spot.ldt\"\n[[target.zone]]\ngamma_deg = [70, 90]\nc_deg = [0, 360]\nmax_cd = 5\n");
  EXPECT_FALSE(p.target.zones_only);
  EXPECT_EQ(p.target.zones->zones().size(), 1u);
}

TEST(TargetZone, NamesEveryFault) {
  const std::string at = "[[target.zone]]\ngamma_deg = [0, 20]\nc_deg = [0, 360]\n";
  const auto zone = [&](const std::string& more) { return error_of(at + more); };
  EXPECT_THAT(zone("min_cdx = 5\n"),
              HasSubstr("target.zone[0].min_cdx: unknown key; the nearest known one is 'min_cd'"));
  EXPECT_THAT(zone(""), HasSubstr("has no bounds"));
  EXPECT_THAT(zone("min_cd = -5\n"), HasSubstr("min_cd: found -5, expected > 0"));
  EXPECT_THAT(zone("min_cd = 50\nmax_cd = 40\n"), HasSubstr("min_cd is not below max_cd: found 50 and 40"));
  EXPECT_THAT(zone("min_cd = 50\nmin_cd_per_klm = 40\n"), HasSubstr("is given together with min_cd"));
  EXPECT_THAT(zone("min_lx = 50\n"), HasSubstr("belongs to a plane"));
  EXPECT_THAT(zone("min_uo = 0.5\n"), HasSubstr("expected a target with kind = \"plane\""));
  EXPECT_THAT(zone("min_of_mean = 0.5\n"), HasSubstr("needs mean_of"));
  EXPECT_THAT(zone("min_of_mean = 0.5\nmean_of = \"a\"\n"),
              HasSubstr("found 'a', expected the name of a zone"));
  EXPECT_THAT(zone("min_cd = 5\nmean_of = \"a\"\n"), HasSubstr("belongs to min_of_mean"));
  EXPECT_THAT(zone("max_cd = 5\n"), HasSubstr("no zone has a minimum"));
  EXPECT_THAT(zone("min_cd = 5\ncell_deg = 0.01\n"), HasSubstr("measuring cells"));
  EXPECT_THAT(zone("min_cd = 5\nh_deg = 3\n"), HasSubstr("expected one kind of angles"));
  EXPECT_THAT(zone("min_cd = 5\nx_mm = 3\n"), HasSubstr("kind = \"plane\""));
  EXPECT_THAT(zone("min_cd = 5\n" + at + "min_cd = 5\nname = \"zone 1\"\n"),
              HasSubstr("name of another zone"));
  EXPECT_THAT(error_of("mode = \"shape\"\n" + at + "min_cd = 5\n"),
              HasSubstr("mode: belongs to a target with a file"));
  EXPECT_THAT(error_of("axis = \"-z\"\n" + at + "min_cd = 5\n"), HasSubstr("axis: is what zones with h_deg"));
}

TEST(TargetZone, NamesFaultsOfRegions) {
  const auto zone = [&](const std::string& region) {
    return error_of("[[target.zone]]\nmin_cd = 5\n" + region);
  };
  EXPECT_THAT(zone(""), HasSubstr("gamma_deg: is missing"));
  EXPECT_THAT(zone("gamma_deg = [20, 20]\nc_deg = 0\n"), HasSubstr("an empty range"));
  EXPECT_THAT(zone("gamma_deg = [20, 10]\nc_deg = 0\n"), HasSubstr("an empty range"));
  EXPECT_THAT(zone("gamma_deg = [20, 190]\nc_deg = 0\n"), HasSubstr("found 190, expected 0 to 180"));
  EXPECT_THAT(zone("gamma_deg = [1, 2, 3]\nc_deg = 0\n"), HasSubstr("found 3 numbers"));
  EXPECT_THAT(zone("gamma_deg = 10\nc_deg = [-200, 200]\n"), HasSubstr("at most 360"));
  EXPECT_THAT(zone("h_deg = 10\nv_deg = 0\n"), HasSubstr("axis: is missing"));
  EXPECT_THAT(error_of(std::string(kZoneFloor) + "[[target.zone]]\nx_mm = 0\ny_mm = 0\nmin_lx = 5\n"),
              HasSubstr("cell_mm: is missing"));
  EXPECT_THAT(
      error_of(std::string(kZoneFloor) + "[[target.zone]]\nx_mm = [0, 900]\ny_mm = [0, 10]\nmin_lx = 5\n"),
      HasSubstr("reaches beyond size_mm"));
  EXPECT_THAT(
      error_of(std::string(kZoneFloor) + "[[target.zone]]\nx_mm = [0, 90]\ny_mm = [0, 10]\nmin_ul = 0.5\n"),
      HasSubstr("along a line"));
  EXPECT_THAT(
      error_of(std::string(kZoneFloor) + "[[target.zone]]\nx_mm = [0, 90]\ny_mm = [0, 10]\nmin_cd = 5\n"),
      HasSubstr("belongs to directions"));
}

TEST(TargetZone, SaysWhichFamiliesZonesAreDesignedFor) {
  const std::string revolution = R"(
[[source]]
kind = "disk"
radius_mm = 1.0
[[reflector]]
family = "revolution"
preset = "parabola"
focal_mm = 8
diameter_mm = 60.0
position_mm = [0, 0, 8]
axis = "-z"
)";
  const std::string zone = "[[target.zone]]\ngamma_deg = [0, 20]\nc_deg = [0, 360]\nmin_cd = 5\n";
  EXPECT_THAT(error_of(zone, revolution),
              HasSubstr("found family = \"revolution\": zones are designed for free forms"));
  EXPECT_THAT(error_of(zone + "[design]\noptimizer = \"tree\"\n"), HasSubstr("found optimizer = \"tree\""));
}

}  // namespace
}  // namespace lucerna
