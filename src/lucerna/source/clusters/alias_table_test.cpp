// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/alias_table.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "lucerna/random.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

/// The probability of each item that the table's cells amount to, without sampling.
std::vector<double> exact_probabilities(std::span<const double> weights) {
  std::vector<float> p(weights.size());
  std::vector<std::uint32_t> alias(weights.size());
  build_alias(weights, p, alias);
  std::vector<double> result(weights.size(), 0.0);
  for (std::size_t i = 0; i < weights.size(); ++i) {
    result[i] += static_cast<double>(p[i]);
    result[alias[i]] += 1.0 - static_cast<double>(p[i]);
  }
  for (double& x : result) x /= static_cast<double>(weights.size());
  return result;
}

TEST(AliasTable, CellsAddUpToTheWeights) {
  for (const std::size_t n : {1u, 2u, 7u, 1000u}) {
    std::vector<double> weights(n);
    for (std::size_t i = 0; i < n; ++i) weights[i] = i % 5 == 3 ? 0.0 : std::exp(10.0 * Rng(n, i).uniform());
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const auto p = exact_probabilities(weights);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_NEAR(p[i], weights[i] / sum, 1e-7 / static_cast<double>(n) + 1e-7 * weights[i] / sum);
      if (weights[i] == 0.0) {
        EXPECT_EQ(p[i], 0.0);
      }
    }
  }
}

TEST(AliasTable, BadWeightsAreRefused) {
  EXPECT_THROW(AliasTable(std::vector<double>{}), std::logic_error);
  EXPECT_THROW(AliasTable(std::vector<double>{0.0, 0.0}), std::logic_error);
  EXPECT_THROW(AliasTable(std::vector<double>{1.0, -1.0}), std::logic_error);
  EXPECT_THROW(AliasTable(std::vector<double>{1.0, NAN}), std::logic_error);
}

TEST(AliasTableStatistical, PicksFollowTheWeightsAndOthersAreRejected) {
  const std::vector<double> weights{1.0, 2.0, 0.0, 4.0, 0.5};
  const AliasTable table(weights);
  std::vector<double> counts(weights.size(), 0.0);
  constexpr int kPicks = 200'000;
  for (std::uint64_t i = 0; i < kPicks; ++i) counts[table.pick(Rng(1, i).uniform())] += 1.0;
  std::vector<double> expected = weights, wrong{1.0, 2.1, 0.0, 3.9, 0.5};
  for (double& x : expected) x *= kPicks / 7.5;
  for (double& x : wrong) x *= kPicks / 7.5;
  EXPECT_GT(test::chi_square_p(counts, expected), test::kFalseAlarm);
  EXPECT_LT(test::chi_square_p(counts, wrong), test::kFalseAlarm);
}

}  // namespace
}  // namespace lucerna
