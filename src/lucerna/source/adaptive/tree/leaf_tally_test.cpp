// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/leaf_tally.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Denser towards low numbers of the first two axes; weights of 1 or 3.
std::vector<TreeItem> tally_items(std::uint64_t seed, std::size_t n) {
  std::vector<TreeItem> items(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    for (std::size_t d = 0; d < 4; ++d)
      items[i].c[d] = static_cast<float>(std::pow(rng.uniform(), d < 2 ? 2.0 : 1.0));
    items[i].weight = i % 3 == 0 ? 3.0F : 1.0F;
  }
  return items;
}

const TreeBox kTallyBox{{0, 0, 0, 0}, {1, 1, 1, 1}};

GrownTree grown_tree(std::vector<TreeItem> items) {
  return grow_trees(items, kTallyBox, {.penalty_nats = 4.0}, 1).front();
}

// The rays that a tree was grown with, counted again, leave it as it was.
TEST(LeafTally, CountsAsTheTreeWasGrown) {
  auto items = tally_items(1, 40'000);
  const GrownTree tree = grown_tree(items);
  ASSERT_GT(tree.nodes.size(), 31u);
  GrownTree counted = tree;
  for (auto& node : counted.nodes) node.weight = 0.0, node.gain_nats = -1.0F;
  LeafTally tally(counted, kTallyBox);
  for (std::size_t at = 0; at < items.size(); at += 10'000) tally.add(std::span(items).subspan(at, 10'000));
  tally.apply(counted);
  EXPECT_DOUBLE_EQ(counted.total_weight, tree.total_weight);
  EXPECT_NEAR(counted.effective_rays, tree.effective_rays, 1e-9 * tree.effective_rays);
  for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
    // Single precision may put a ray at a cut on its other side.
    EXPECT_NEAR(counted.nodes[i].weight, tree.nodes[i].weight, 3.0) << i;
    if (!(tree.nodes[i].gain_nats > 0.0F)) continue;
    EXPECT_NEAR(counted.nodes[i].gain_nats, tree.nodes[i].gain_nats, 0.01F * tree.nodes[i].gain_nats + 0.1F)
        << i;
  }
}

// Nodes hold what lies in their boxes.
TEST(LeafTally, CountsOtherRaysByTheirPlace) {
  GrownTree tree = grown_tree(tally_items(1, 20'000));
  auto others = tally_items(2, 50'000);
  LeafTally tally(tree, kTallyBox);
  tally.add(others);
  tally.apply(tree);
  const auto& root = tree.nodes.front();
  double below = 0.0, all = 0.0;
  for (const TreeItem& item : others) {
    const auto weight = static_cast<double>(item.weight);
    all += weight;
    below += item.c[root.axis] < static_cast<float>(root.cut) / kTreeCuts ? weight : 0.0;
  }
  EXPECT_DOUBLE_EQ(root.weight, all);
  EXPECT_NEAR(tree.nodes[1].weight, below, 3.0);
  EXPECT_DOUBLE_EQ(tree.nodes[1].weight + tree.nodes[root.right].weight, all);
}

TEST(LeafTally, NoRayIsLost) {
  GrownTree tree = grown_tree(tally_items(1, 20'000));
  auto beyond = tally_items(3, 1000);
  for (TreeItem& item : beyond) item.c[0] += 2.0F, item.c[3] -= 5.0F;
  LeafTally tally(tree, kTallyBox);
  tally.add(beyond);
  tally.apply(tree);
  double all = 0.0;
  for (const TreeItem& item : beyond) all += static_cast<double>(item.weight);
  EXPECT_DOUBLE_EQ(tree.total_weight, all);
}

TEST(LeafTally, WithoutWeightNothingChanges) {
  const GrownTree tree = grown_tree(tally_items(1, 20'000));
  GrownTree same = tree;
  LeafTally(same, kTallyBox).apply(same);
  EXPECT_EQ(same.total_weight, tree.total_weight);
  EXPECT_EQ(same.nodes[1].weight, tree.nodes[1].weight);
}

TEST(LeafTally, SameBitsForAnyNumberOfThreads) {
  GrownTree many = grown_tree(tally_items(1, 20'000)), one = many;
  const auto others = tally_items(4, 100'000);
  const auto count = [&](GrownTree& tree) {
    std::vector<TreeItem> copy = others;
    LeafTally tally(tree, kTallyBox);
    tally.add(copy);
    tally.apply(tree);
  };
  count(many);
  const ThreadLimit limit(1);
  count(one);
  for (std::size_t i = 0; i < one.nodes.size(); ++i) {
    EXPECT_EQ(many.nodes[i].weight, one.nodes[i].weight);
    EXPECT_EQ(many.nodes[i].gain_nats, one.nodes[i].gain_nats);
  }
}

}  // namespace
}  // namespace lucerna
