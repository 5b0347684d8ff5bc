// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "lucerna/cli/output/describe.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "tests/support/temp_dir.h"

namespace lucerna::cli {
namespace {

using testing::HasSubstr;

class DescribeRays : public testing::Test {
 protected:
  Description described(const std::string& text, const std::string& format = "") {
    write_file(dir_ / "a.txt", text);
    Session session;
    session.start();
    return describe_rays((dir_ / "a.txt").string(), format, session);
  }
  static std::string joined(const Description& d) {
    std::string text;
    for (const std::string& line : d.lines) text += line + "\n";
    return text;
  }

 private:
  test::TempDir dir_;
};

constexpr const char* kFourRays =
    "# columns: x y z kx ky kz flux\n# flux_lm: 8\n0 0 0 0 0 1 1\n1 0 0 0 0 1 1\n0 2 0 0 0 1 2\n0 0 3 0 0 -1 "
    "4\n";

TEST_F(DescribeRays, SaysWhatTheFileHolds) {
  const Description d = described(kFourRays);
  EXPECT_EQ(d.json["rays"], 4);
  EXPECT_EQ(d.json["flux_lm"], 8.0);
  EXPECT_EQ(d.json["extent_mm"]["max"], Json({1.0, 2.0, 3.0}));
  EXPECT_DOUBLE_EQ(d.json["backwards_share"].get<double>(), 0.5);
  EXPECT_EQ(d.json["equal_weights"], false);
  EXPECT_THAT(joined(d), HasSubstr("50.0000 % of the flux"));
  EXPECT_THAT(joined(d), HasSubstr("(0.0000, 0.0000, 0.0000) to (1.0000, 2.0000, 3.0000)"));
}

TEST_F(DescribeRays, WithoutLightThereIsNoEtendue) {
  const Description d = described("# columns: x y z kx ky kz flux\n0 0 0 0 0 1 0\n1 0 0 0 0 1 0\n");
  EXPECT_EQ(d.json["etendue_mm2sr"]["p50"], 0.0);
  EXPECT_TRUE(d.json["flux_lm"].is_null()) << "none is stated";
}

TEST_F(DescribeRays, ReadsAsTheFormatThatIsAskedFor) {
  EXPECT_EQ(described("0 0 0 0 0 1 1\n", "text").json["format"], "text");
  EXPECT_THROW(described("0 0 0 0 0 1 1\n", "tm25"), InputError);
}

TEST(DescribeJson, NumbersThatAreNoneAreNull) {
  EXPECT_TRUE(to_json(std::optional<double>()).is_null());
  EXPECT_TRUE(to_json(1.0 / 0.0).is_null());
  EXPECT_EQ(to_json(std::optional<double>(2.5)), 2.5);
}

}  // namespace
}  // namespace lucerna::cli
