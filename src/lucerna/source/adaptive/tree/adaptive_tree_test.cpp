// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/adaptive_tree.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr TreeBox kUnitBox{{0, 0, 0, 0}, {1, 1, 1, 1}};

template <class Keep>
std::vector<TreeItem> items(std::size_t n, const Keep& keep, float weight = 1.0f) {
  std::vector<TreeItem> all;
  for (std::uint64_t i = 0; all.size() < n; ++i) {
    Rng rng(1, i);
    TreeItem item;
    for (float& x : item.c) x = static_cast<float>(rng.uniform());
    item.weight = weight;
    if (rng.uniform() < keep(item)) all.push_back(item);
  }
  return all;
}

DensityTree fit(std::vector<TreeItem> rays, double penalty = 8.0, const TreeBox& box = kUnitBox) {
  return prune_tree(grow_trees(rays, box, {.penalty_nats = penalty}, 1).front(), penalty);
}

TEST(AdaptiveTree, EvenLightIsOneLeaf) {
  EXPECT_EQ(fit(items(100000, [](const TreeItem&) { return 1.0; }), 12.0).leaves(), 1u);
}

TEST(AdaptiveTree, FindsAStepAndItsHeight) {
  const auto step = [](const TreeItem& i) { return i.c[2] < 0.375f ? 1.0 : 0.25; };
  const DensityTree tree = fit(items(200000, step), 12.0);
  ASSERT_EQ(tree.leaves(), 2u);
  EXPECT_EQ(tree.nodes[0].axis, 2);
  EXPECT_EQ(tree.nodes[0].cut, 24);
  const double low = tree_density(tree, kUnitBox, {0.5, 0.5, 0.1, 0.5});
  const double high = tree_density(tree, kUnitBox, {0.5, 0.5, 0.9, 0.5});
  EXPECT_NEAR(low / high, 4.0, 0.1);
  EXPECT_NEAR(0.375 * low + 0.625 * high, 1.0, 1e-12);
  EXPECT_EQ(tree_density(tree, kUnitBox, {0.5, 0.5, 1.1, 0.5}), 0.0);
}

TEST(AdaptiveTree, FindsACheckerThatNoSingleCutShows) {
  const auto checker = [](const TreeItem& i) {
    return (static_cast<int>(8 * i.c[0]) + static_cast<int>(4 * i.c[3])) % 2 == 0 ? 1.0 : 0.25;
  };
  const DensityTree tree = fit(items(200000, checker), 8.0);
  EXPECT_GE(tree.leaves(), 32u);
  EXPECT_LE(tree.leaves(), 70u);
  EXPECT_NEAR(tree_density(tree, kUnitBox, {0.06, 0.5, 0.5, 0.1}), 1.6, 0.15);
  EXPECT_NEAR(tree_density(tree, kUnitBox, {0.19, 0.5, 0.5, 0.1}), 0.4, 0.08);
}

TEST(AdaptiveTree, EmptySpaceIsEmpty) {
  const auto corner = [](const TreeItem& i) { return i.c[0] < 0.25f && i.c[1] < 0.5f ? 1.0 : 0.0; };
  const DensityTree tree = fit(items(20000, corner));
  EXPECT_EQ(tree_density(tree, kUnitBox, {0.9, 0.2, 0.5, 0.5}), 0.0);
  EXPECT_NEAR(tree_density(tree, kUnitBox, {0.1, 0.2, 0.5, 0.5}), 8.0, 0.1);
}

TEST(AdaptiveTree, WeightsCountAsFluxAndNotAsRays) {
  // A few heavy rays are no evidence: their noise is that of their number.
  auto rays = items(
      400, [](const TreeItem&) { return 1.0; }, 1e6f);
  for (const TreeItem& light : items(400, [](const TreeItem&) { return 1.0; })) rays.push_back(light);
  EXPECT_EQ(fit(rays).leaves(), 1u);
  // Flux, not number: heavy above, light below.
  auto uneven = items(
      50000, [](const TreeItem& i) { return i.c[1] < 0.5f ? 1.0 : 0.0; }, 1.0f);
  for (const TreeItem& i : items(
           50000, [](const TreeItem& j) { return j.c[1] < 0.5f ? 0.0 : 1.0; }, 3.0f)) {
    uneven.push_back(i);
  }
  EXPECT_NEAR(tree_density(fit(uneven), kUnitBox, {0.5, 0.75, 0.5, 0.5}), 1.5, 0.02);
}

TEST(AdaptiveTree, LeavesShareAllOfTheLight) {
  const auto hill = [](const TreeItem& i) {
    return std::exp(-20.0 * std::pow(static_cast<double>(i.c[0]) - 0.4, 2));
  };
  const DensityTree tree = fit(items(50000, hill), 4.0);
  EXPECT_GT(tree.leaves(), 4u);
  double sum = 0.0, volume = 0.0;
  for_each_leaf(tree, kUnitBox, [&](const TreeBox& box, double share) {
    sum += share;
    volume += box.volume();
    std::array<double, 4> middle;
    for (std::size_t d = 0; d < 4; ++d) middle[d] = 0.5 * (box.low[d] + box.high[d]);
    EXPECT_NEAR(tree_density(tree, kUnitBox, middle), share / box.volume(), 1e-12 / box.volume());
    EXPECT_EQ(TreeLookup(tree, kUnitBox).density(middle), tree_density(tree, kUnitBox, middle));
  });
  EXPECT_NEAR(sum, 1.0, 1e-12);
  EXPECT_NEAR(volume, 1.0, 1e-12);
}

TEST(AdaptiveTree, SameBitsForAnyNumberOfThreads) {
  const auto hill = [](const TreeItem& i) { return static_cast<double>(i.c[0] * i.c[1]); };
  const auto rays = items(120000, hill);
  const DensityTree many = fit(rays, 5.0);
  const ThreadLimit one(1);
  EXPECT_EQ(fit(rays, 5.0), many);
}

TEST(AdaptiveTree, TreesOfDifferentNumbersCutDifferently) {
  const auto hill = [](const TreeItem& i) { return static_cast<double>(i.c[0]); };
  auto rays = items(60000, hill);
  const auto both = grow_trees(rays, kUnitBox, {.penalty_nats = 4.0}, 2);
  EXPECT_NE(prune_tree(both[0], 4.0).nodes, prune_tree(both[1], 4.0).nodes);
  // Together they are what each is alone.
  for (std::uint64_t t = 0; t < 2; ++t) {
    const auto alone = grow_trees(rays, kUnitBox, {.penalty_nats = 4.0, .tree_number = t}, 1);
    EXPECT_EQ(prune_tree(both[t], 4.0), prune_tree(alone.front(), 4.0));
  }
}

TEST(AdaptiveTree, FineTreesAreOfferedAllCuts) {
  const auto hill = [](const TreeItem& i) { return static_cast<double>(i.c[0]); };
  auto rays = items(10000, hill);
  const auto trees = grow_trees(rays, kUnitBox, {.penalty_nats = 4.0, .fine_trees = 1}, 2);
  const auto alone = grow_trees(rays, kUnitBox, {.penalty_nats = 4.0, .fine_trees = 1}, 1);
  EXPECT_EQ(prune_tree(trees[0], 4.0), prune_tree(alone.front(), 4.0));
  const auto coarse = grow_trees(rays, kUnitBox, {.penalty_nats = 4.0, .tree_number = 1}, 1);
  EXPECT_EQ(prune_tree(trees[1], 4.0), prune_tree(coarse.front(), 4.0));
  // More is offered at the first node, so more is gained there.
  EXPECT_GE(trees[0].nodes.front().gain_nats, trees[1].nodes.front().gain_nats);
  EXPECT_NE(prune_tree(trees[0], 4.0).nodes, prune_tree(trees[1], 4.0).nodes);
}

TEST(AdaptiveTree, PruningKeepsWhatPays) {
  auto rays = items(50000, [](const TreeItem& i) { return 0.5 + 0.5 * static_cast<double>(i.c[0]); });
  const GrownTree grown = grow_trees(rays, kUnitBox, {.penalty_nats = 2.0}, 1).front();
  std::size_t last = ~std::size_t{0};
  for (const double penalty : {2.0, 4.0, 8.0, 16.0, 1e9}) {
    const std::size_t splits = retained_splits(grown, penalty);
    EXPECT_LE(splits, last);
    EXPECT_EQ(prune_tree(grown, penalty).leaves(), splits + 1);
    last = splits;
  }
  EXPECT_EQ(last, 0u);
}

TEST(AdaptiveTree, AnAxisOnWhichAllAgreeIsNotCut) {
  auto rays = items(5000, [](const TreeItem& i) { return i.c[0] < 0.5f ? 1.0 : 0.2; });
  for (TreeItem& i : rays) i.c[1] = 0.25f;
  TreeBox box = kUnitBox;
  box.low[1] = box.high[1] = 0.25;
  const DensityTree tree = fit(rays, 8.0, box);
  EXPECT_NEAR(tree_density(tree, box, {0.2, 0.25, 0.5, 0.5}), 1.0 / 0.6, 0.06);
}

}  // namespace
}  // namespace lucerna
