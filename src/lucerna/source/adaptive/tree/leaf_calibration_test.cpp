// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/leaf_calibration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr TreeBox kUnit{{0, 0, 0, 0}, {1, 1, 1, 1}};

/// Even light with stripes of `contrast` along axis 1, four periods, and a slope along axis 2.
std::vector<TreeItem> striped(std::size_t n, double contrast, std::uint64_t seed) {
  std::vector<TreeItem> rays;
  for (std::uint64_t i = 0; rays.size() < n; ++i) {
    Rng rng(seed, i);
    TreeItem ray;
    for (float& x : ray.c) x = static_cast<float>(rng.uniform());
    ray.weight = 1.0f;
    const double stripe = 1.0 + contrast * std::sin(8.0 * std::numbers::pi * static_cast<double>(ray.c[1]));
    if (2.0 * rng.uniform() < stripe * static_cast<double>(ray.c[2])) rays.push_back(ray);
  }
  return rays;
}

struct Fit {
  std::vector<DensityTree> trees;
  std::vector<std::vector<double>> shares;
};

Fit fitted(std::vector<TreeItem> rays, std::size_t trees, double penalty) {
  Fit fit;
  for (const GrownTree& grown : grow_trees(rays, kUnit, {.penalty_nats = penalty}, trees)) {
    PrunedTree pruned = prune_exactly(grown, penalty);
    fit.trees.push_back(std::move(pruned.tree)), fit.shares.push_back(std::move(pruned.leaf_shares));
  }
  return fit;
}

/// The share of the trees' mean in each eighth of axis 1, relative to even light.
std::array<double, 8> eighths(const Fit& fit) {
  std::array<double, 8> sums{};
  for (std::size_t t = 0; t < fit.trees.size(); ++t) {
    std::size_t leaf = 0;
    for_each_leaf(fit.trees[t], kUnit, [&](const TreeBox& box, double) {
      for (std::size_t k = 0; k < 8; ++k) {
        const double low = std::max(box.low[1], 0.125 * static_cast<double>(k)),
                     high = std::min(box.high[1], 0.125 * static_cast<double>(k + 1));
        sums[k] += 8.0 * fit.shares[t][leaf] * std::max(0.0, high - low) / box.width(1) /
                   static_cast<double>(fit.trees.size());
      }
      ++leaf;
    });
  }
  return sums;
}

/// Root mean square of what the stripes in eighths are off: their mean over half a period is 2 / pi.
double off(const std::array<double, 8>& sums, double contrast) {
  double squares = 0.0;
  for (std::size_t k = 0; k < 8; ++k) {
    const double truth = 1.0 + (k % 2 == 0 ? 1.0 : -1.0) * contrast * 2.0 / std::numbers::pi;
    squares += (sums[k] - truth) * (sums[k] - truth) / 8.0;
  }
  return std::sqrt(squares);
}

TEST(LeafCalibration, BringsBackAPatternThatLeavesCanFollow) {
  constexpr double kContrast = 0.12;
  auto rays = striped(60'000, kContrast, 1);
  const TreeMarginals marginals(rays, kUnit);
  // Trees of other rays, without stripes, but with leaves at many places.
  Fit fit = fitted(striped(60'000, 0.0, 2), 8, 1.5);
  const double before = off(eighths(fit), kContrast);
  calibrate_leaves(fit.trees, kUnit, marginals, fit.shares);
  const double after = off(eighths(fit), kContrast);
  EXPECT_GT(before, 0.06);
  EXPECT_LT(after, 0.65 * before);
  for (const auto& shares : fit.shares)
    EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1.0, 1e-12);
}

/// Light on a coil: twelve stripes across axis 0 and 1, in which place and direction go together.
std::vector<TreeItem> coil(std::size_t n, std::uint64_t seed) {
  std::vector<TreeItem> rays;
  for (std::uint64_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    TreeItem ray;
    const double turn = rng.uniform(), across = rng.uniform(), side = rng.uniform();
    const double along = (std::floor(12.0 * rng.uniform()) + turn + 0.2 * across) / 13.2;
    ray.c = {static_cast<float>(turn), static_cast<float>(along), static_cast<float>(0.5 * (across + side)),
             static_cast<float>(rng.uniform())};
    ray.weight = 1.0f;
    rays.push_back(ray);
  }
  return rays;
}

// Leaves that are too coarse for a coil cannot have its sums. Twelve passes would come nearer to them by
// shares that the leaves' own rays contradict by 0.1 nats and more; a model of a filament was twice as far
// from the truth then.
TEST(LeafCalibration, EndsWhereTheLeavesOwnRaysContradictIt) {
  auto rays = coil(100'000, 8);
  const TreeMarginals marginals(rays, kUnit);
  Fit fit = fitted(std::move(rays), 1, 60.0);
  const auto counted = fit.shares;
  calibrate_leaves(fit.trees, kUnit, marginals, fit.shares);
  const double moved_nats = divergence_nats(counted, fit.shares);
  EXPECT_GT(moved_nats, 1e-4);
  EXPECT_LT(moved_nats, 3.0 * kMaxDivergence_nats);  // a pass goes on to its end
  EXPECT_EQ(divergence_nats(counted, counted), 0.0);
  EXPECT_DOUBLE_EQ(divergence_nats(std::vector<std::vector<double>>{{0.5, 0.5}},
                                   std::vector<std::vector<double>>{{0.25, 0.75}}),
                   0.5 * std::log(2.0) + 0.5 * std::log(2.0 / 3.0));
}

TEST(LeafCalibration, LeavesAreSettledWithinTheRoundingOfTheirSteps) {
  auto rays = striped(20'000, 0.3, 3);
  Fit fit = fitted(rays, 2, 3.0);
  const TreeMarginals marginals(rays, kUnit);
  calibrate_leaves(fit.trees, kUnit, marginals, fit.shares);
  const DensityTree tree = settled({fit.trees[0], fit.shares[0]});
  std::size_t leaf = 0;
  double sum = 0.0;
  for_each_leaf(tree, kUnit, [&](const TreeBox&, double share) {
    // Ten levels, each rounded by at most half a standard error of its own rays.
    EXPECT_NEAR(share, fit.shares[0][leaf], 5.0 * std::sqrt((share + 1e-4) / 20'000.0) + 0.2 * share);
    sum += share, ++leaf;
  });
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_EQ(leaf, fit.shares[0].size());
}

TEST(LeafCalibration, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    auto rays = striped(30'000, 0.2, 4);
    Fit fit = fitted(rays, 4, 3.0);
    const TreeMarginals marginals(rays, kUnit);
    calibrate_leaves(fit.trees, kUnit, marginals, fit.shares);
    return fit.shares;
  };
  EXPECT_EQ(run(1), run(2));
}

TEST(LeafCalibration, ContradictionIsSeenWhereItIs) {
  Fit fit = fitted(striped(60'000, 0.0, 5), 4, 2.5);
  const TreeMarginals same(striped(60'000, 0.0, 6), kUnit), other(striped(60'000, 0.12, 7), kUnit);
  // The slope along axis 2 is steps in the trees, which rays of any set contradict a little.
  constexpr double kSteps = 8.0, kClear = 16.0;
  EXPECT_LT(contradictions(fit.trees, kUnit, same, fit.shares)[0], 5.0);
  EXPECT_LT(contradictions(fit.trees, kUnit, same, fit.shares)[1], kSteps);
  EXPECT_GT(contradictions(fit.trees, kUnit, other, fit.shares)[0], kClear);
  EXPECT_LT(contradictions(fit.trees, kUnit, other, fit.shares)[1], kSteps);
}

}  // namespace
}  // namespace lucerna
