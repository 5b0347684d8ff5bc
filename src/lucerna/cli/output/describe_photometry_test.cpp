// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>

#include "lucerna/cli/output/describe.h"
#include "lucerna/core/io/file.h"
#include "lucerna/photometric_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

// 100 cd everywhere: 400 pi lm, and no angle at which it is at half.
TEST(DescribePhotometry, HasTheFiguresOfEvenLight) {
  const test::TempDir dir;
  IntensityDistribution even = uniform_distribution(30.0, 5.0);
  std::fill(even.cd.begin(), even.cd.end(), 100.0);
  const std::string file = (dir / "even.ldt").string();
  write_file(file, ldt_text({even, {}}));
  const Description d = describe_photometry(file, {});
  EXPECT_NEAR(d.json["flux_lm"].get<double>(), 400.0 * std::numbers::pi, 0.5);
  EXPECT_NEAR(d.json["peak"]["intensity"].get<double>(), 100.0, 1e-3);
  EXPECT_TRUE(d.warnings.empty());
  EXPECT_THAT(d.lines.front(), testing::HasSubstr("type C"));
  EXPECT_THAT(d.lines, testing::Contains(testing::HasSubstr("flux by zone")));
}

}  // namespace
}  // namespace lucerna::cli
