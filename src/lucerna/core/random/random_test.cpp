// SPDX-License-Identifier: Apache-2.0
#include "lucerna/random.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/support/statistics.h"

namespace lucerna {
namespace {

// Known answers of the Random123 distribution (kat_vectors, philox4x32-10).
TEST(Philox, KnownAnswers) {
  const std::array<std::uint32_t, 4> zero{0x6627e8d5u, 0xe169c58du, 0xbc57ac4cu, 0x9b00dbd8u};
  EXPECT_EQ(philox4x32(0, 0, 0), zero);
  const std::array<std::uint32_t, 4> ones{0x408f276du, 0x41c83b0eu, 0xa20bc7c6u, 0x6d5451fdu};
  EXPECT_EQ(philox4x32(~0ull, ~0ull, ~0ull), ones);
}

TEST(Rng, SameKeySameNumbersOtherKeyOthers) {
  Rng a(7, 9), b(7, 9), other_index(7, 10), other_seed(8, 9), other_stream(7, 9, 1);
  for (int i = 0; i < 20; ++i) {
    const std::uint32_t x = a.bits();
    EXPECT_EQ(x, b.bits());
    EXPECT_NE(x, other_index.bits());
    EXPECT_NE(x, other_seed.bits());
    EXPECT_NE(x, other_stream.bits());
  }
}

std::vector<double> pair_counts(double power) {
  std::vector<double> counts(std::size_t{32} * 32, 0.0);
  for (std::uint64_t i = 0; i < 400'000; ++i) {
    Rng rng(11, i);
    const int x = static_cast<int>(32 * std::pow(rng.uniform(), power)),
              y = static_cast<int>(32 * rng.uniform());
    counts[static_cast<std::size_t>(32 * y + x)] += 1.0;
  }
  return counts;
}

TEST(RngStatistical, PairsAreUniformAndAWarpOfThreePerCentIsSeen) {
  EXPECT_GT(test::chi_square_uniform_p(pair_counts(1.0)), test::kFalseAlarm);
  EXPECT_LT(test::chi_square_uniform_p(pair_counts(1.03)), test::kFalseAlarm);
}

}  // namespace
}  // namespace lucerna
