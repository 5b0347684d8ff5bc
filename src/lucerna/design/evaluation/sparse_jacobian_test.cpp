// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/sparse_jacobian.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "lucerna/random.h"

namespace lucerna {
namespace {

using PairOfBlock = std::pair<std::uint32_t, std::uint32_t>;

SparseSums::Block random_block(Rng& rng) {
  SparseSums::Block out;
  for (double& x : out) x = rng.uniform() - 0.5;
  return out;
}

// Pairs that come again at once, soon and late, and more of them than a table begins with.
TEST(SparseSums, HoldWhatWasAddedInItsOrder) {
  constexpr std::uint32_t kCells = 50;
  SparseSums sums(kCells);
  std::map<PairOfBlock, SparseSums::Block> expected;
  Rng rng(1, 0);
  for (int i = 0; i < 100000; ++i) {
    const std::uint32_t bins = i % 3 == 0 ? 2 : 400;
    const PairOfBlock at{static_cast<std::uint32_t>(rng.uniform() * bins),
                         static_cast<std::uint32_t>(rng.uniform() * kCells)};
    const SparseSums::Block values = random_block(rng);
    sums.add(at.first, at.second, values);
    SparseSums::Block& block = expected.try_emplace(at, SparseSums::Block{}).first->second;
    for (std::size_t k = 0; k < values.size(); ++k) block[k] += values[k];
  }
  sums.settle();
  ASSERT_EQ(sums.size(), expected.size());
  for (std::size_t i = 0; i < sums.size(); ++i)
    ASSERT_EQ(sums.at(i), expected.at({sums.bin(i), sums.cell(i)})) << i;
}

TEST(SparseSums, FewThatWereAddedAreThereToo) {
  SparseSums sums(7);
  SparseSums::Block one;
  one.fill(1.0);
  for (int i = 0; i < 3; ++i) sums.add(2, 6, one);
  sums.add(3, 0, one);
  EXPECT_EQ(sums.size(), 0u);
  EXPECT_FALSE(sums.is_settled());
  sums.settle();
  EXPECT_TRUE(sums.is_settled());
  sums.settle();
  ASSERT_EQ(sums.size(), 2u);
  EXPECT_EQ(sums.bin(0), 2u);
  EXPECT_EQ(sums.cell(0), 6u);
  EXPECT_EQ(sums.at(0)[15], 3.0);
  EXPECT_EQ(sums.at(1)[0], 1.0);
}

}  // namespace
}  // namespace lucerna
