// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/parse/arguments.h"

#include <gtest/gtest.h>

#include "lucerna/core/io/error.h"

namespace lucerna::cli {
namespace {

TEST(Arguments, CountsTakeExponents) {
  EXPECT_EQ(parse_count("1e6"), 1'000'000u);
  EXPECT_EQ(parse_count("250000"), 250'000u);
  for (const char* bad : {"", "1.5", "-3", "1e400", "nan", "10x", "0x10", " 1"}) {
    EXPECT_THROW(parse_count(bad), UsageError) << bad;
  }
}

TEST(Arguments, SizesAreDecimalOrBinaryAsWritten) {
  EXPECT_EQ(parse_size("64k"), 64'000u);
  EXPECT_EQ(parse_size("1MB"), 1'000'000u);
  EXPECT_EQ(parse_size("64KiB"), 65'536u);
  EXPECT_EQ(parse_size("1.5MiB"), 1'572'864u);
  EXPECT_EQ(parse_size("123"), 123u);
  for (const char* bad : {"", "k", "-1k", "64q", "1.5"}) EXPECT_THROW(parse_size(bad), UsageError) << bad;
}

TEST(Arguments, RangesAreHalfOpen) {
  EXPECT_EQ(parse_range("1e3").last, 1000u);
  EXPECT_EQ(parse_range("5:1e3").first, 5u);
  for (const char* bad : {"0", "5:5", "6:5", ":5", "5:", "a:b"})
    EXPECT_THROW(parse_range(bad), UsageError) << bad;
}

TEST(Arguments, NumbersAndRotations) {
  EXPECT_EQ(parse_numbers("1,-2,3.5", 3), (std::vector<double>{1, -2, 3.5}));
  for (const char* bad : {"1,2", "1,2,3,4", "1,,3", "1,2,", ""}) {
    EXPECT_THROW(parse_numbers(bad, 3), UsageError) << bad;
  }
  EXPECT_EQ(parse_words("x,kx,,flux"), (std::vector<std::string>{"x", "kx", "", "flux"}));
  EXPECT_TRUE(parse_words("").empty());
  EXPECT_EQ(parse_rotation("z:90").vector({1, 0, 0}), (Vec3{0, 1, 0}));
  EXPECT_EQ(parse_rotation("-z:90").vector({1, 0, 0}), (Vec3{0, -1, 0}));
  EXPECT_EQ(parse_rotation("0,0,2:90").vector({1, 0, 0}), (Vec3{0, 1, 0}));
  for (const char* bad : {"z", "q:90", "0,0,0:3", "z:x"})
    EXPECT_THROW(parse_rotation(bad), UsageError) << bad;
}

TEST(Arguments, SharesArePercentOrNumbers) {
  EXPECT_DOUBLE_EQ(parse_share("1%"), 0.01);
  EXPECT_DOUBLE_EQ(parse_share("0.5 %"), 0.005);
  EXPECT_DOUBLE_EQ(parse_share("0.02"), 0.02);
  for (const char* bad : {"0", "-1%", "150%", "%", "one"}) EXPECT_THROW(parse_share(bad), UsageError) << bad;
}

}  // namespace
}  // namespace lucerna::cli
