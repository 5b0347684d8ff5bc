// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/run/piece_size.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

// Light off mirrors: 20 M rays a second. Through a solid: 0.6 M. Setting up for 4 s: larger pieces pay.
TEST(PieceSize, GrowsUntilPiecesTakeSeconds) {
  constexpr std::uint64_t kMax = std::uint64_t{1} << 24;
  const auto last_of = [](double rays_per_s, double set_up_s) {
    PieceSize size(kMax);
    for (int i = 0; i < 12; ++i) size.took(set_up_s + static_cast<double>(size.rays()) / rays_per_s);
    return size.rays();
  };
  EXPECT_EQ(last_of(20e6, 0.0), kMax);
  EXPECT_EQ(last_of(0.6e6, 0.0), std::uint64_t{1} << 21);
  EXPECT_GT(last_of(0.6e6, 4.0), std::uint64_t{1} << 21);
  EXPECT_EQ(PieceSize(1000).rays(), 1000u);
}

}  // namespace
}  // namespace lucerna
