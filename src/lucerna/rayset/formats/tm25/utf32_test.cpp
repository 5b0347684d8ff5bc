// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/tm25/utf32.h"

#include <gtest/gtest.h>

#include <cstddef>

namespace lucerna {
namespace {

std::string there_and_back(std::string_view text) { return utf8_from_utf32(utf32_from_utf8(text)); }

TEST(Utf32, EveryScalarValueSurvives) {
  for (std::uint32_t c = 1; c <= 0x10FFFF; c += c < 0x3000 ? 1 : 97) {
    if (c >= 0xD800 && c <= 0xDFFF) continue;
    const std::vector<std::uint32_t> one{c};
    ASSERT_EQ(utf32_from_utf8(utf8_from_utf32(one)), one) << c;
  }
}

TEST(Utf32, BrokenTextIsReplacedNeverLost) {
  const std::string replacement = "\xEF\xBF\xBD";
  EXPECT_EQ(there_and_back("a\x80z"), "a" + replacement + "z");
  EXPECT_EQ(there_and_back("\xC0\xAF"), replacement + replacement);  // overlong
  EXPECT_EQ(there_and_back("\xED\xA0\x80"), replacement);            // a surrogate
  EXPECT_EQ(there_and_back("\xF0\x9F\x92"), replacement);            // cut off
  EXPECT_EQ(there_and_back("\xE2\x82z"), replacement + "z");
  EXPECT_EQ(utf8_from_utf32(std::vector<std::uint32_t>{0x110000, 65}), replacement + "A");
}

TEST(Utf32, StopsAtTheFirstZero) { EXPECT_EQ(utf8_from_utf32(std::vector<std::uint32_t>{65, 0, 66}), "A"); }

}  // namespace
}  // namespace lucerna
