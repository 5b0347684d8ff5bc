// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "lucerna/cli/output/describe.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

TEST(DescribeCatalogue, ListsGlassesAndWarnsOfThoseThatCannotBeRead) {
  const test::TempDir dir;
  const std::string file = (dir / "made.AGF").string();
  write_file(file,
             "NM CLEAR 1 0 1.5\nCD 2.25 0 0 0 0 0\nLD 0.4 0.7\nNM INFRARED 1\nCD 4 0 0 0 0 0\nLD 1 2\n"
             "NM BROKEN 1\nLD 0.4 0.7\nNM CLEAR 1\nCD 4 0 0 0 0 0\nLD 0.4 0.7\n");
  EXPECT_TRUE(is_glass_catalogue(file));
  EXPECT_FALSE(is_glass_catalogue("agf.txt"));
  const Description d = describe_catalogue(file);
  ASSERT_EQ(d.json["glasses"].size(), 2u);
  EXPECT_NEAR(d.json["glasses"][0]["index_d"].get<double>(), 1.5, 1e-12);
  EXPECT_TRUE(d.json["glasses"][1]["index_d"].is_null()) << "not at the d line";
  EXPECT_EQ(d.lines.size(), 3u);
  ASSERT_EQ(d.warnings.size(), 2u);
  EXPECT_THAT(d.warnings[0], testing::HasSubstr("BROKEN"));
  EXPECT_THAT(d.warnings[1], testing::HasSubstr("CLEAR: the name stands more than once"));
  write_file(file, "CC nothing\n");
  EXPECT_THROW(describe_catalogue(file), InputError);
}

}  // namespace
}  // namespace lucerna::cli
