// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lucerna {
namespace {

using testing::ElementsAre;

/// The two bytes of each unit, the high one first or last, after a byte order mark.
std::string utf16(const std::u16string& units, bool high_first) {
  std::string bytes;
  const auto put = [&](char16_t unit) {
    const char high = static_cast<char>(unit >> 8), low = static_cast<char>(unit & 0xFF);
    bytes += high_first ? high : low;
    bytes += high_first ? low : high;
  };
  put(0xFEFF);
  for (const char16_t unit : units) put(unit);
  return bytes;
}

TEST(Text, IsDecodedFromEachEncoding) {
  const std::string expected = "M\u00FCller 10 \u00B0C, 2 \u20AC";
  EXPECT_EQ(decoded_text(expected), expected);
  EXPECT_EQ(decoded_text("\xEF\xBB\xBF" + expected), expected);
  EXPECT_EQ(decoded_text("M\xFCller 10 \xB0"
                         "C, 2 \x80"),
            expected)
      << "Windows-1252";
  for (const bool high_first : {false, true})
    EXPECT_EQ(decoded_text(utf16(u"M\u00FCller 10 \u00B0C, 2 \u20AC", high_first)), expected);
}

TEST(Text, OfUtf16HasPairsAndBrokenOnes) {
  EXPECT_EQ(decoded_text(utf16(u"a\U0001F4A1z", true)), "a\U0001F4A1z");
  const char16_t broken[] = {'a', 0xD83D, 'z', 0xDCA1, 0xD83D, 0};
  EXPECT_EQ(decoded_text(utf16(broken, false)), "a\uFFFDz\uFFFD\uFFFD");
  EXPECT_EQ(decoded_text(utf16(u"ab", false) + "c"), "ab\uFFFD") << "half a unit at the end";
}

TEST(Text, EndsAtACtrlZ) {
  EXPECT_EQ(decoded_text("one\x1A two"), "one");
  EXPECT_EQ(decoded_text(utf16(u"one\x1A two", true)), "one");
}

TEST(Text, HasLinesAtEveryKindOfEnd) {
  EXPECT_THAT(lines_of("a\r\nb\nc\rd\n\ne\n"), ElementsAre("a", "b", "c", "d", "", "e"));
  EXPECT_THAT(lines_of(""), ElementsAre());
}

TEST(Text, LosesBlanksAtItsEnds) {
  EXPECT_EQ(trimmed(" \t a b \r\n"), "a b");
  EXPECT_EQ(trimmed(" \t"), "");
}

TEST(Text, HasWordsBetweenBlanksAndTabs) {
  EXPECT_EQ(blank_separated("  one\ttwo  three\r"), (std::vector<std::string_view>{"one", "two", "three"}));
  EXPECT_TRUE(blank_separated(" \t ").empty());
}

TEST(Text, IsANumberAsAWhole) {
  EXPECT_EQ(number_from("+1.5E+000"), 1.5);
  EXPECT_EQ(number_from("3.7E-0400"), 0.0);
  for (const char* const bad : {"", "1e400", "nan", "inf", "0x10", "1 2", "1,5", "-"})
    EXPECT_FALSE(number_from(bad)) << bad;
}

}  // namespace
}  // namespace lucerna
