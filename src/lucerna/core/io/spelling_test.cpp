// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/io/spelling.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(Spelling, DistanceIsAMetricOfLetters) {
  EXPECT_EQ(edit_distance("", ""), 0u);
  EXPECT_EQ(edit_distance("", "abc"), 3u);
  EXPECT_EQ(edit_distance("trace", "trace"), 0u);
  EXPECT_EQ(edit_distance("tracee", "trace"), 1u);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3u);
  EXPECT_EQ(edit_distance("sitting", "kitten"), 3u);
}

TEST(Spelling, OneSlipIsMisspelt) {
  for (const char* word : {"focal_m", "focal_mmm", "focal_mn", "foacl_mm", "focal_mm_"})
    EXPECT_TRUE(is_misspelt(word, "focal_mm")) << word;
  for (const char* word : {"focal_mm", "focal", "length_mm", "focal_in"})
    EXPECT_FALSE(is_misspelt(word, "focal_mm")) << word;
}

TEST(Spelling, NamesTheNearestWord) {
  const WordSet commands{"compare", "compress", "convert", "design", "info", "trace"};
  EXPECT_EQ(nearest_word("tracee", commands), "trace");
  EXPECT_EQ(nearest_word("anything", {}), "");
  EXPECT_EQ(meant_word("desing", commands), "design");
  EXPECT_EQ(meant_word("compres", commands), "compress");
  EXPECT_EQ(meant_word("frobnicate", commands), "") << "nothing like it";
  EXPECT_EQ(meant_word("x", commands), "");
  EXPECT_EQ(meant_word("trace", {}), "");
}

}  // namespace
}  // namespace lucerna
