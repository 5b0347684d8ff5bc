// SPDX-License-Identifier: Apache-2.0
#include "lucerna/core/cpu/huge_pages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

namespace lucerna {
namespace {

// Only advice: what is written before and after is there, and nothing is asked of small arrays or of none.
TEST(HugePages, ChangeNoByte) {
  constexpr std::size_t kLarge = (std::size_t{6} << 20) + 13;
  std::vector<unsigned char> bytes(kLarge, 7);
  advise_huge_pages(bytes.data() + 1, bytes.size() - 1);
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 7), static_cast<std::ptrdiff_t>(kLarge));
  std::fill(bytes.begin(), bytes.end(), static_cast<unsigned char>(9));
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 9), static_cast<std::ptrdiff_t>(kLarge));
  advise_huge_pages(bytes.data(), 100);
  advise_huge_pages(nullptr, 0);
}

}  // namespace
}  // namespace lucerna
