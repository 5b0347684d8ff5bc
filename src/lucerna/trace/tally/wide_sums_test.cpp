// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/tally/wide_sums.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr std::size_t kBins = 5;

/// A tally whose sums are up to `most`.
Tally random_tally(Rng& rng, std::int64_t most) {
  const auto draw = [&] {
    const std::uint64_t bits = (std::uint64_t{rng.bits()} << 32) | rng.bits();
    return static_cast<std::int64_t>(bits % static_cast<std::uint64_t>(most));
  };
  Tally t;
  t.absorbed.resize(2);
  t.lost.resize(2);
  t.lost_rays.resize(2);
  t.bins.assign(2, std::vector<std::int64_t>(kBins));
  for_each_sum(t, [&](std::int64_t* sums, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) sums[i] = draw();
  });
  return t;
}

std::vector<Int128> values_of(const Tally& t) {
  std::vector<Int128> v{emitted_of(t), out_direct_of(t), out_reflected_of(t)};
  for (std::size_t i = 0; i < 2; ++i) v.push_back(absorbed_of(t, i));
  for (std::size_t i = 0; i < 2; ++i) v.push_back(lost_of(t, i));
  for (std::size_t d = 0; d < 2; ++d) {
    Int128 all = 0;
    for (std::size_t k = 0; k < kBins; ++k) v.push_back(bin_of(t, d, k)), all += v.back();
    EXPECT_TRUE(all == all_bins_of(t, d));
  }
  return v;
}

TEST(WideSums, OrdinaryTalliesHaveOneLane) {
  Rng rng(1, 0);
  Tally sum = random_tally(rng, 1 << 30);
  for (int i = 0; i < 100; ++i) sum += random_tally(rng, 1 << 30);
  EXPECT_TRUE(sum.high.empty());
  EXPECT_TRUE(fits_one_lane(sum));
  EXPECT_TRUE(emitted_of(sum) == sum.emitted);
}

// 300 tallies of nearly 2^62 units: far beyond 64 bits. The sums are those of 128-bit numbers, and bytes do
// not depend on the order or grouping. One lane with wrapping, the obvious wrong variant, fails the first.
TEST(WideSums, SumsBeyond63BitsAreExactInAnyOrder) {
  Rng rng(2, 0);
  std::vector<Tally> parts;
  std::vector<Int128> expected(3 + 2 + 2 + 2 * kBins);
  for (int i = 0; i < 300; ++i) {
    parts.push_back(random_tally(rng, std::int64_t{1} << (i % 2 == 0 ? 62 : 40)));
    const auto values = values_of(parts.back());
    for (std::size_t k = 0; k < values.size(); ++k) expected[k] += values[k];
  }
  Tally forward = parts.front(), backward = parts.back(), grouped;
  for (std::size_t i = 1; i < parts.size(); ++i) forward += parts[i];
  for (std::size_t i = parts.size() - 1; i-- > 0;) backward += parts[i];
  for (std::size_t i = 0; i < parts.size(); i += 10) {
    Tally group = parts[i];
    for (std::size_t k = i + 1; k < i + 10; ++k) group += parts[k];
    if (i == 0) {
      grouped = group;
    } else {
      grouped += group;
    }
  }
  EXPECT_FALSE(forward.high.empty());
  EXPECT_TRUE(values_of(forward) == expected);
  EXPECT_TRUE(forward == backward);
  EXPECT_TRUE(forward == grouped);
}

// What a reduction over many machines does: lanes are split, added one by one, and settled at the end.
TEST(WideSums, LanesAddOneByOne) {
  Rng rng(3, 0);
  for (const int bits : {20, 62}) {
    Tally sum = random_tally(rng, std::int64_t{1} << bits), lanes = sum;
    split_lanes(lanes);
    for (int i = 0; i < 50; ++i) {
      Tally part = random_tally(rng, std::int64_t{1} << bits);
      sum += part;
      split_lanes(part);
      for (std::size_t k = 0; k < lanes.high.size(); ++k) lanes.high[k] += part.high[k];
      std::vector<const std::int64_t*> from;
      for_each_sum(part, [&](const std::int64_t* sums, std::size_t) { from.push_back(sums); });
      std::size_t at = 0;
      for_each_sum(lanes, [&](std::int64_t* sums, std::size_t n) {
        for (std::size_t k = 0; k < n; ++k) sums[k] += from[at][k];
        ++at;
      });
    }
    settle_lanes(lanes);
    EXPECT_TRUE(lanes == sum) << bits;
    EXPECT_EQ(lanes.high.empty(), bits == 20);
  }
}

// The border: 2^62 - 1 stays in one lane, 2^62 does not, in whatever sum it comes.
TEST(WideSums, TwoLanesBeginAtTwoToThe62) {
  Rng rng(4, 0);
  for (std::size_t which = 0; which < 3 + 2 + 2 + 2 * kBins; ++which) {
    Tally t = random_tally(rng, 2), one = t;
    std::size_t at = 0;
    for_each_sum(t, [&](std::int64_t* sums, std::size_t n) {
      for (std::size_t k = 0; k < n; ++k) sums[k] = at++ == which ? (std::int64_t{1} << 62) - 2 : 0;
    });
    at = 0;
    for_each_sum(one, [&](std::int64_t* sums, std::size_t n) {
      for (std::size_t k = 0; k < n; ++k) sums[k] = at++ == which ? 1 : 0;
    });
    t += one;
    EXPECT_TRUE(t.high.empty()) << which;
    t += one;
    EXPECT_FALSE(t.high.empty()) << which;
    EXPECT_TRUE(values_of(t)[which] == Int128{1} << 62) << which;
    split_lanes(t);
    settle_lanes(t);
    EXPECT_FALSE(t.high.empty()) << which;
  }
}

}  // namespace
}  // namespace lucerna
