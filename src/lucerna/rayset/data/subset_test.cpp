// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/subset.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <vector>

#include "lucerna/core/io/error.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

TEST(RaySubset, AscendsAndLiesInTheFile) {
  for (const std::uint64_t available : {1ull, 7ull, 1000ull, (1ull << 40) + 3}) {
    for (const std::uint64_t count : {1ull, 3ull, 7ull, 999ull}) {
      if (count > available) continue;
      const RaySubset subset(available, count, 5);
      for (std::uint64_t k = 0; k + 1 < count; ++k) EXPECT_LT(subset.at(k), subset.at(k + 1));
      EXPECT_LT(subset.at(count - 1), available);
    }
  }
  EXPECT_THROW(RaySubset(5, 6, 1), InputError);
}

TEST(RaySubset, AllOfAFileIsTheFile) {
  const RaySubset subset(100, 100, 3);
  for (std::uint64_t k = 0; k < 100; ++k) EXPECT_EQ(subset.at(k), k);
}

TEST(RaySubset, BlocksGiveTheChosenRaysWhereverTheyAreCut) {
  RayBlock all;
  all.resize(1000, 1);
  for (std::size_t i = 0; i < 1000; ++i) all.x_mm[i] = all.extra[0][i] = static_cast<float>(i);
  for (const std::uint64_t count : {0ull, 1ull, 37ull, 500ull, 1000ull}) {
    const RaySubset subset(1000, count, 9);
    for (const std::size_t block_size : {1u, 10u, 333u, 1000u}) {
      RayBlock chosen;
      for (std::size_t first = 0; first < 1000; first += block_size) {
        RayBlock block;
        block.extra.resize(1);
        for (std::size_t i = first; i < std::min<std::size_t>(1000, first + block_size); ++i)
          block.append(all, i);
        subset.select(block, first, chosen);
      }
      ASSERT_EQ(chosen.size(), count);
      for (std::uint64_t k = 0; k < count; ++k) {
        EXPECT_EQ(chosen.extra[0][k], static_cast<float>(subset.at(k)));
      }
    }
  }
}

TEST(RaySubsetStatistical, EveryRayIsAsLikely) {
  std::vector<double> counts(1000, 0.0);
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const RaySubset subset(1000, 70, seed);
    for (std::uint64_t k = 0; k < 70; ++k) counts[subset.at(k)] += 1.0;
  }
  // Expected counts differ a little between stretches of 14 and 15 rays; coarse cells of whole stretches are
  // equal.
  std::vector<double> tenths(10, 0.0);
  for (std::size_t i = 0; i < 1000; ++i) tenths[i / 100] += counts[i];
  for (const double tenth : tenths) EXPECT_EQ(tenth, 7.0 * 2000.0);
  const std::vector<double> first_stretch(counts.begin(), counts.begin() + 14);
  EXPECT_GT(test::chi_square_uniform_p(first_stretch), test::kFalseAlarm);
  // The first ray of 14 chosen too often: one cell of 14 that is off by d is off by d / sqrt(14), root mean
  // square.
  const double n = std::accumulate(first_stretch.begin(), first_stretch.end(), 0.0);
  std::vector<double> wrong = first_stretch;
  wrong[0] += 1.3 * test::seen_deviation(n, 14.0) * std::sqrt(14.0) * n / 14.0;
  EXPECT_LT(test::chi_square_uniform_p(wrong), test::kFalseAlarm);
}

}  // namespace
}  // namespace lucerna
