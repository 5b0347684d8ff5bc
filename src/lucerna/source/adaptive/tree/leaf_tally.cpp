// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/leaf_tally.h"

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/adaptive/tree/split_items.h"

namespace lucerna {

namespace {

/// So many items are divided before they go on, each by itself: what they meet then is near in memory.
constexpr std::size_t kTogether = 32;
/// As many are divided on two threads.
constexpr std::size_t kOnThreads = std::size_t{1} << 15;

/// Log likelihood that a cut gains, as count_gains has it, for `rays` effective rays a unit of weight.
double gain_of(double left, double right, std::uint32_t cut, double rays) {
  const double f = cut * (1.0 / kTreeCuts), all = left + right;
  const double below = left > 0.0 ? left * std::log(left / (all * f)) : 0.0;
  const double above = right > 0.0 ? right * std::log(right / (all * (1.0 - f))) : 0.0;
  return rays * (below + above);
}

}  // namespace

LeafTally::LeafTally(const GrownTree& tree, const TreeBox& box)
    : nodes_(tree.nodes.size()), weight_(tree.nodes.size(), 0.0), squares_(tree.nodes.size(), 0.0) {
  struct Pending {
    std::size_t node;
    TreeBox box;
  };
  std::vector<Pending> stack{{0, box}};
  while (!stack.empty()) {
    const Pending p = stack.back();
    stack.pop_back();
    const GrownTree::Node& node = tree.nodes[p.node];
    if (node.right == 0) continue;
    const TreeBox upper = p.box.half(node.axis, node.cut, true);
    nodes_[p.node] = {node.right, node.axis, static_cast<float>(upper.low[node.axis])};
    stack.push_back({p.node + node.right, upper});
    stack.push_back({p.node + 1, p.box.half(node.axis, node.cut, false)});
  }
}

void LeafTally::count(std::size_t leaf, const TreeItem& item) {
  const auto w = static_cast<double>(item.weight);
  weight_[leaf] += w;
  squares_[leaf] += w * w;
}

void LeafTally::add_below(std::size_t node, std::span<TreeItem> items) {
  const Node n = nodes_[node];
  if (n.right == 0) {
    for (const TreeItem& item : items) count(node, item);
    return;
  }
  if (items.size() <= kTogether) {
    for (const TreeItem& item : items) {
      std::size_t at = node;
      while (nodes_[at].right != 0) at += item.c[nodes_[at].axis] < nodes_[at].edge ? 1 : nodes_[at].right;
      count(at, item);
    }
    return;
  }
  const std::size_t middle =
      split_items(items, [&](const TreeItem& item) { return item.c[n.axis] < n.edge; });
  const auto lower = [&] { add_below(node + 1, items.first(middle)); };
  const auto upper = [&] { add_below(node + n.right, items.subspan(middle)); };
  if (items.size() >= kOnThreads) {
    parallel_invoke(lower, upper);
  } else {
    lower(), upper();
  }
}

void LeafTally::add(std::span<TreeItem> items) { add_below(0, items); }

void LeafTally::apply(GrownTree& tree) const {
  LUCERNA_CHECK(tree.nodes.size() == weight_.size(), "a tree of {} nodes, counted in one of {}",
                tree.nodes.size(), weight_.size());
  std::vector<double> weight = weight_, squares = squares_;
  for (std::size_t i = weight.size(); i-- > 0;) {
    const GrownTree::Node& node = tree.nodes[i];
    if (node.right == 0) continue;
    weight[i] = weight[i + 1] + weight[i + node.right];
    squares[i] = squares[i + 1] + squares[i + node.right];
  }
  if (!(weight.front() > 0.0)) return;
  for (std::size_t i = 0; i < weight.size(); ++i) {
    GrownTree::Node& node = tree.nodes[i];
    node.weight = weight[i];
    if (node.right == 0) continue;
    const double rays = squares[i] > 0.0 ? weight[i] / squares[i] : 0.0;
    node.gain_nats = static_cast<float>(gain_of(weight[i + 1], weight[i + node.right], node.cut, rays));
  }
  tree.total_weight = weight.front();
  tree.effective_rays = weight.front() * weight.front() / squares.front();
}

}  // namespace lucerna
