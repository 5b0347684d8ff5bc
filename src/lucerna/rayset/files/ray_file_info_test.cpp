// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/ray_file_info.h"

#include <gtest/gtest.h>

#include "lucerna/ray_file.h"
#include "tests/support/data_dir.h"
#include "tests/support/random_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

TEST(RayFileInfo, SaysWhatTheFileHolds) {
  const test::TempDir dir;
  RaySet set = test::random_ray_set(3000, 1, {{ColumnKind::wavelength_nm, "wavelength nm"}});
  write_ray_set(dir / "a", set, "lighttools-binary", {.length_unit = "cm"});
  const RayFileInfo info = describe_ray_file(dir / "a");
  EXPECT_EQ(info.format, "lighttools-binary");
  EXPECT_EQ(info.length_unit, "cm");
  EXPECT_EQ(info.summary.count, 3000u);
  EXPECT_NEAR(info.flux_ratio.value(), info.summary.weight_sum / 337.5, 1e-9);
  EXPECT_NE(info.spectrum.find("one per ray"), std::string::npos);
  EXPECT_EQ(info.some_rays.size(), 3000u);
  write_ray_set(dir / "a", test::random_ray_set(0, 1), "tm25");
  EXPECT_EQ(describe_ray_file(dir / "a").summary.count, 0u);
}

TEST(RayFileInfoData, MeasuredLed) {
  LUCERNA_DATA_FILE(path, "rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY");
  const RayFileInfo info = describe_ray_file(path);
  EXPECT_NEAR(info.flux_ratio.value(), 1.0, 1e-4);
  EXPECT_EQ(info.spectrum, "450 to 620 nm, table of 86 points");
  EXPECT_EQ(info.surface.surface.kind, SurfaceKind::plane);
  EXPECT_TRUE(info.summary.equal_weights);
  EXPECT_TRUE(info.warnings.empty());
}

}  // namespace
}  // namespace lucerna
