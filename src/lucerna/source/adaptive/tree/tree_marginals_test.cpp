// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/tree_marginals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>
#include <span>

#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr std::uint32_t kBits = 5;
constexpr std::size_t kSide = 32, kCells = kSide * kSide;

/// Cells that hold `n` rays, drawn from a density.
template <class Density>
TreeMarginals::Cells drawn(std::size_t n, std::uint64_t seed, const Density& density) {
  TreeMarginals::Cells cells{std::vector<double>(kCells, 0.0), std::vector<double>(kCells, 0.0)};
  std::size_t kept = 0;
  for (std::uint64_t i = 0; kept < n; ++i) {
    Rng rng(seed, i);
    const auto cell = static_cast<std::size_t>(rng.uniform() * static_cast<double>(kCells));
    if (rng.uniform() * 2.0 >= density(cell / kSide, cell % kSide)) continue;
    cells.weight[cell] += 1.0, cells.squares[cell] += 1.0, ++kept;
  }
  return cells;
}

std::vector<double> even() { return std::vector<double>(kCells, 1.0 / static_cast<double>(kCells)); }

double squared_distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

std::vector<double> shrunken(const TreeMarginals::Cells& cells, std::size_t n) {
  return shrunken_shares(cells, static_cast<double>(n), static_cast<double>(n), even(), kBits);
}

std::vector<double> shares_of(const TreeMarginals::Cells& cells, std::size_t n) {
  std::vector<double> shares = cells.weight;
  for (double& s : shares) s /= static_cast<double>(n);
  return shares;
}

TEST(TreeMarginals, NoiseAloneHardlyMovesTheModel) {
  constexpr std::size_t kRays = 50'000;
  double moved = 0.0, raw = 0.0;
  for (std::uint64_t seed = 1; seed <= 8; ++seed) {
    const auto cells = drawn(kRays, seed, [](std::size_t, std::size_t) { return 1.0; });
    moved += squared_distance(shrunken(cells, kRays), even());
    raw += squared_distance(shares_of(cells, kRays), even());
  }
  EXPECT_LT(moved, 0.03 * raw);
}

TEST(TreeMarginals, NearerToTheTruthThanModelAndRays) {
  constexpr std::size_t kRays = 50'000;
  const auto stripes = [](std::size_t, std::size_t y) { return y / 4 % 2 == 0 ? 1.05 : 0.95; };
  std::vector<double> truth(kCells);
  for (std::size_t i = 0; i < kCells; ++i) truth[i] = stripes(0, i % kSide) / static_cast<double>(kCells);
  for (std::uint64_t seed = 11; seed <= 14; ++seed) {
    const auto cells = drawn(kRays, seed, stripes);
    const double found = squared_distance(shrunken(cells, kRays), truth);
    EXPECT_LT(found, 0.4 * squared_distance(even(), truth));
    EXPECT_LT(found, 0.1 * squared_distance(shares_of(cells, kRays), truth));
  }
}

TEST(TreeMarginals, SharesKeepTheirSumAndDarkCellsStayDark) {
  constexpr std::size_t kRays = 20'000;
  const auto half = [](std::size_t x, std::size_t) { return x < kSide / 2 ? 1.5 : 0.5; };
  std::vector<double> model = even();
  double lit = 0.0;
  for (std::size_t i = 0; i < kCells; ++i) lit += model[i] *= i % kSide == 3 ? 0.0 : 1.0;
  for (double& share : model) share /= lit;
  const auto cells = drawn(kRays, 21, half);
  const auto shares =
      shrunken_shares(cells, static_cast<double>(kRays), static_cast<double>(kRays), model, kBits);
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-12);
  for (std::size_t i = 3; i < kCells; i += kSide) EXPECT_EQ(shares[i], 0.0);
}

TEST(TreeMarginals, CountsEveryRayInEveryPair) {
  std::vector<TreeItem> items;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    Rng rng(5, i);
    TreeItem item;
    for (float& x : item.c) x = static_cast<float>(4.0 * rng.uniform() * rng.uniform() - 1.0);
    item.weight = i % 2 == 0 ? 1.0f : 0.5f;
    items.push_back(item);
  }
  const TreeMarginals m(items, {{-1, -1, -1, -1}, {3, 3, 3, 3}});
  EXPECT_DOUBLE_EQ(m.total_weight(), 3750.0);
  EXPECT_DOUBLE_EQ(m.total_squares(), 2500.0 + 625.0);
  for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
    const auto& w = m.cells(p).weight;
    EXPECT_EQ(w.size(), kAxisPairs[p].side() * kAxisPairs[p].side());
    EXPECT_NEAR(std::accumulate(w.begin(), w.end(), 0.0), 3750.0, 1e-9);
  }
}

TEST(TreeMarginals, RaysAreAddedAndTakenAway) {
  const TreeBox box{{0, 0, 0, 0}, {1, 1, 1, 1}};
  std::vector<TreeItem> items(3000);
  for (std::size_t i = 0; i < items.size(); ++i) {
    Rng rng(5, i);
    for (float& c : items[i].c) c = static_cast<float>(rng.uniform());
    items[i].weight = i % 2 == 0 ? 1.0F : 2.0F;
  }
  const TreeMarginals whole(items, box);
  TreeMarginals parts = whole;
  parts.clear();
  EXPECT_EQ(parts.total_weight(), 0.0);
  parts.add(std::span(items).first(1000));
  parts.add(std::span(items).subspan(1000));
  EXPECT_EQ(parts.total_weight(), whole.total_weight());
  EXPECT_EQ(parts.total_squares(), whole.total_squares());
  for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
    EXPECT_EQ(parts.cells(p).weight, whole.cells(p).weight) << p;
    EXPECT_EQ(parts.cells(p).squares, whole.cells(p).squares) << p;
  }
}

}  // namespace
}  // namespace lucerna
