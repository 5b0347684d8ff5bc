// SPDX-License-Identifier: Apache-2.0
#include "lucerna/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/file.h"
#include "lucerna/error.h"
#include "lucerna/photometric_file.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "tests/support/paths.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

namespace fs = std::filesystem;

void write_disk(const fs::path& file, double radius_mm, std::uint64_t seed, FluxUnit unit = FluxUnit::lumen) {
  RaySet set;
  set.header.flux_unit = unit;
  set.header.set_flux(100.0);
  set.rays.resize(20'000);
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = radius_mm;
  make_emitter(options)->emit(Sequence(SequenceKind::random, seed), 0, set.rays);
  write_ray_set(file, set, "tm25");
}

void write_light(const fs::path& file, double spread) {
  PhotometricFile light;
  IntensityDistribution& d = light.distribution;
  d.c_deg = {0.0, 90.0, 180.0, 270.0};
  for (int gamma = 0; gamma <= 90; gamma += 5) d.gamma_deg.push_back(gamma);
  d.cd.clear();
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (const double gamma : d.gamma_deg) d.cd.push_back(1000.0 * std::exp(-gamma / spread));
  }
  write_photometric_file(file, light, PhotometricFormat::ldt);
}

TEST(Comparison, OfRayFilesIsThatOfTheirRays) {
  const test::TempDir dir;
  write_disk(dir / "a.tm25ray", 1.0, 1);
  write_disk(dir / "same.tm25ray", 1.0, 2);
  write_disk(dir / "wider.tm25ray", 1.5, 2);
  FileComparisonOptions options;
  options.cells_um = {300.0};
  options.pictures = dir.path();
  const FileComparison same = compare(dir / "a.tm25ray", dir / "same.tm25ray", options);
  ASSERT_TRUE(same.rays);
  EXPECT_FALSE(same.light);
  EXPECT_EQ(same.rays->reference_rays, 20'000u);
  const RaySetComparison rays =
      compare_ray_sets(read_ray_set(dir / "a.tm25ray").rays, read_ray_set(dir / "same.tm25ray").rays);
  EXPECT_EQ(same.rays->views.near.error, rays.near.error);
  ASSERT_EQ(same.rays->pictures.size(), 1u) << "no light to the side";
  EXPECT_TRUE(fs::exists(dir / same.rays->pictures[0].file));

  const FileComparison wider = compare(dir / "a.tm25ray", dir / "wider.tm25ray", options);
  EXPECT_LT(same.rays->views.near.excess, 4.0 * same.rays->views.near.standard_error);
  EXPECT_GT(wider.rays->views.near.excess, 10.0 * wider.rays->views.near.standard_error);
  const double ratio = wider.rays->test_etendue.p50_mm2sr / wider.rays->reference_etendue.p50_mm2sr;
  EXPECT_NEAR(ratio, 2.25, 0.3);
  ASSERT_EQ(wider.rays->focus_plane.size(), 1u);
  EXPECT_GT(wider.rays->focus_plane[0].l1, 3.0 * wider.rays->focus_plane[0].floor);
}

TEST(Comparison, OfLumensAndWattsIsBySharesAndSaysSo) {
  const test::TempDir dir;
  write_disk(dir / "lm.tm25ray", 1.0, 1);
  write_disk(dir / "w.tm25ray", 1.0, 1, FluxUnit::watt);
  const FileComparison found = compare(dir / "lm.tm25ray", dir / "w.tm25ray");
  EXPECT_EQ(found.rays->views.far.error, 0.0);
  ASSERT_EQ(found.warnings.size(), 1u);
  EXPECT_NE(found.warnings[0].find("w.tm25ray in W; each is compared by shares"), std::string::npos)
      << found.warnings[0];
  EXPECT_TRUE(compare(dir / "lm.tm25ray", dir / "lm.tm25ray").warnings.empty());
}

TEST(Comparison, OfLightDistributionsIsThatOfTheirValues) {
  const test::TempDir dir;
  write_light(dir / "a.ldt", 20.0);
  write_light(dir / "b.ldt", 30.0);
  FileComparisonOptions options;
  options.pictures = dir.path();
  const FileComparison equal = compare(dir / "a.ldt", dir / "a.ldt");
  ASSERT_TRUE(equal.light);
  EXPECT_FALSE(equal.rays);
  EXPECT_EQ(equal.light->distributions.relative_rms.mean, 0.0);
  EXPECT_FALSE(fs::exists(dir / "polar.svg")) << "none without a folder";
  const FileComparison found = compare(dir / "a.ldt", dir / "b.ldt", options);
  EXPECT_EQ(found.light->distributions.relative_rms.mean,
            compare_distributions(read_photometric_file(dir / "a.ldt").distribution,
                                  read_photometric_file(dir / "b.ldt").distribution)
                .relative_rms.mean);
  EXPECT_GT(found.light->boxes.c48.excess, 0.05);
  EXPECT_TRUE(fs::exists(dir / "polar.svg"));
}

// What is wrong is said of the file that is wrong.
TEST(Comparison, OfDifferentKindsIsRefused) {
  const test::TempDir dir;
  write_light(dir / "a.ldt", 20.0);
  write_disk(dir / "a.tm25ray", 1.0, 1);
  write_file(dir / "empty.ldt", "");
  write_file(dir / "rest.ies", std::string(300, 'x'));
  const auto refused = [&](const char* a, const char* b) {
    return test::message_of<InputError>([&] { static_cast<void>(compare(dir / a, dir / b)); });
  };
  for (const char* other : {"none.ldt", "none.tm25ray", "empty.ldt", "rest.ies"}) {
    for (const std::string& said : {refused("a.ldt", other), refused(other, "a.ldt")})
      EXPECT_NE(said.find(other), std::string::npos) << other << ": " << said;
    EXPECT_EQ(refused("a.ldt", other).find("rays"), std::string::npos) << refused("a.ldt", other);
  }
  const std::string rays = refused("a.ldt", "a.tm25ray");
  EXPECT_NE(rays.find("a.tm25ray: found rays or a model, expected a light distribution as "),
            std::string::npos)
      << rays;
  EXPECT_NE(refused("a.tm25ray", "none.tm25ray").find("none.tm25ray"), std::string::npos);
  fs::create_directory(dir / "folder");
  const std::string folder = refused("a.ldt", "folder");
  EXPECT_NE(folder.find("folder: found no result.json, expected the folder of a trace"), std::string::npos)
      << folder;
}

// What was repaired is named; strictly, it is refused.
TEST(Comparison, NamesWhatWasOddInTheFiles) {
  const test::TempDir dir;
  const fs::path repaired = test::source_dir() / "tests/data/photometry/own_ies_missing_360_plane.ies";
  const FileComparison light = compare(repaired, repaired);
  const auto names_the_repair = [](const std::string& warning) {
    return warning.find("own_ies_missing_360_plane.ies: ") != std::string::npos &&
           warning.find("end at 315") != std::string::npos;
  };
  EXPECT_EQ(std::ranges::count_if(light.warnings, names_the_repair), 2);
  FileComparisonOptions strict;
  strict.rays = 1000;
  strict.photometric.strict = true;
  EXPECT_THROW(static_cast<void>(compare(repaired, repaired, strict)), InputError);

  write_disk(dir / "a.tm25ray", 1.0, 1);
  EXPECT_NO_THROW(static_cast<void>(compare(dir / "a.tm25ray", dir / "a.tm25ray", strict)));
  // Bytes behind the rays.
  write_file(dir / "b.tm25ray", read_file(dir / "a.tm25ray", 1 << 26) + "tail");
  ASSERT_FALSE(compare(dir / "a.tm25ray", dir / "b.tm25ray").warnings.empty());
  const std::string said = test::message_of<InputError>(
      [&] { static_cast<void>(compare(dir / "a.tm25ray", dir / "b.tm25ray", strict)); });
  EXPECT_NE(said.find("b.tm25ray: "), std::string::npos) << said;
}

TEST(Comparison, OfDifferentUnitsIsRefused) {
  const test::TempDir dir;
  write_light(dir / "a.ldt", 20.0);
  PhotometricFile watts = read_photometric_file(dir / "a.ldt");
  watts.distribution.unit = FluxUnit::watt;
  write_photometric_file(dir / "w.ies", watts, PhotometricFormat::ies_2019);
  const std::string said =
      test::message_of<InputError>([&] { static_cast<void>(compare(dir / "a.ldt", dir / "w.ies")); });
  EXPECT_NE(said.find("w.ies: found W/sr, expected cd as "), std::string::npos) << said;
}

}  // namespace
}  // namespace lucerna
