// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/cli/output/describe.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

constexpr const char* kEven =
    "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\nScatterType BRDF\n"
    "SampleRotation 1\n0\nAngleOfIncidence 1\n0\nScatterAzimuth 2\n0 180\nScatterRadial 2\n0 90\n"
    "Monochrome\nDataBegin\nTIS 0.6\n0.2 0.2\n0.2 0.2\nDataEnd\n";

TEST(DescribeBsdf, SaysWhatIsStatedAndWhatIsThere) {
  const test::TempDir dir;
  const std::string file = (dir / "even.bsdf").string();
  write_file(file, kEven);
  ASSERT_TRUE(is_bsdf_file(file));
  const Description d = describe_bsdf(file);
  ASSERT_EQ(d.lines.size(), 2u);
  EXPECT_EQ(d.lines[0],
            "  format              bsdf of Zemax, 2 azimuths to 180 degrees, 2 radial angles to 90");
  // 0.2 pi
  EXPECT_THAT(d.lines[1], testing::HasSubstr("0.6000 stated, 0.628"));
  EXPECT_NEAR(d.json["incidences"][0]["reflectance_of_values"].get<double>(), 0.6283, 2e-3);
  write_file(file, "Source Measured\n");
  EXPECT_THROW(describe_bsdf(file), InputError);
  EXPECT_FALSE(is_bsdf_file("bsdf.txt"));
}

}  // namespace
}  // namespace lucerna::cli
