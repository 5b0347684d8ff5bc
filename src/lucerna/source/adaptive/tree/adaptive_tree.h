// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace lucerna {

/// Splits are at multiples of 1 / kTreeCuts of a box's edge.
inline constexpr std::uint32_t kTreeCuts = 64;

/// A ray in the four numbers of its support's chart.
struct TreeItem {
  std::array<float, 4> c{};
  float weight = 0.0f;
};

/// A box of the four numbers: low <= c <= high. An axis with low == high is one on which all rays agree.
struct TreeBox {
  std::array<double, 4> low{}, high{};

  /// The part below or above `cut` / kTreeCuts of edge `axis`.
  TreeBox half(std::uint32_t axis, std::uint32_t cut, bool upper) const;
  double width(std::size_t d) const { return high[d] - low[d]; }
  /// Product of the edges that are not zero.
  double volume() const;
  friend bool operator==(const TreeBox&, const TreeBox&) = default;
};

/// A node in preorder: the left (lower) child is the next node, the right one `right` nodes further on.
struct TreeNode {
  std::uint32_t right = 0;  // 0 = leaf
  std::uint8_t axis = 0, cut = 0;
  /// Step of the left child's share (tree_share); kLeftEmpty or kRightEmpty when one side has nothing.
  std::int16_t step = 0;

  bool is_leaf() const { return right == 0; }
  friend bool operator==(const TreeNode&, const TreeNode&) = default;
};

inline constexpr std::int16_t kLeftEmpty = -32768, kRightEmpty = 32767, kLargestStep = 4095;

/// Share of a node's flux that its left child has: with f = cut / kTreeCuts, odds f / (1 - f) * exp(step *
/// h), h = 1 / sqrt(rays f (1 - f)) the standard error of the log odds, 1 / 256 to 1. `rays` is what the node
/// holds. Uses no library function but sqrt, so that every machine decodes the same bits.
double tree_share(const TreeNode& node, double rays);

/// A density that is constant on the boxes of a binary tree.
struct DensityTree {
  std::vector<TreeNode> nodes;  // at least the root
  /// Effective rays behind it (equal weights: their number): fixes how finely shares are stored.
  double rays = 0.0;

  std::size_t leaves() const { return (nodes.size() + 1) / 2; }
  friend bool operator==(const DensityTree&, const DensityTree&) = default;
};

/// A node's place in a tree as a number: the root's, and a child's from its parent's. Offers of cuts hang on
/// it.
inline constexpr std::uint64_t kRootPath = 1;
inline std::uint64_t child_path(std::uint64_t path, bool upper) {
  std::uint64_t x = (path << 1 | (upper ? 1u : 0u)) * 0x9E3779B97F4A7C15u;
  x ^= x >> 29;
  return x * 0xBF58476D1CE4E5B9u;
}
/// Small nodes offer the cuts 1 + offset, 5 + offset, ... with this offset (0..3), unless another is far
/// better.
inline std::uint32_t cut_offset(std::uint64_t tree_number, std::uint64_t path, std::uint32_t axis) {
  return static_cast<std::uint32_t>(child_path(path ^ tree_number << 32, axis % 2 != 0) >> (40 + axis)) & 3u;
}

/// Calls `leaf(box, share)` for every leaf of `tree` in the box, in preorder; shares sum to 1.
template <class Leaf>
void for_each_leaf(const DensityTree& tree, const TreeBox& box, const Leaf& leaf) {
  struct Pending {
    std::size_t node;
    TreeBox box;
    double share;
  };
  std::vector<Pending> stack{{0, box, 1.0}};
  while (!stack.empty()) {
    const Pending p = stack.back();
    stack.pop_back();
    const TreeNode& n = tree.nodes[p.node];
    if (n.is_leaf()) {
      leaf(p.box, p.share);
      continue;
    }
    const double left = tree_share(n, tree.rays * p.share);
    stack.push_back({p.node + n.right, p.box.half(n.axis, n.cut, true), p.share * (1.0 - left)});
    stack.push_back({p.node + 1, p.box.half(n.axis, n.cut, false), p.share * left});
  }
}

/// A tree with the statistics of its making: what pruning needs.
struct GrownTree {
  struct Node {
    std::uint32_t right = 0;
    std::uint8_t axis = 0, cut = 0;
    float gain_nats = 0.0f;
    double weight = 0.0;
  };
  std::vector<Node> nodes;
  double total_weight = 0.0, effective_rays = 0.0;
};

/// Sets of axes: bit d is axis d.
inline constexpr std::uint32_t kAllAxes = 15, kPlaceAxes = 3, kDirectionAxes = 12;

struct GrowOptions {
  /// A split must gain so much likelihood; see prune for the size that is kept.
  double penalty_nats = 4.0;
  /// Trees of different numbers offer different cuts, so that their average is smoother than each.
  std::uint64_t tree_number = 0;
  /// Trees below this number offer all cuts everywhere; small nodes of the others a quarter of them (needed
  /// for averages; faster).
  std::uint64_t fine_trees = 0;
  /// These axes are cut as long as that gains enough, and only then the others: what other trees sum over
  /// before they see it, such a tree sees with all rays.
  std::uint32_t first_axes = kAllAxes;
};

/// Splits `box` by the likelihood of `items` (which it reorders) until nothing is gained: histograms of 64
/// bins an axis, the axis and cut of largest gain; where no cut gains, a test on the six pairs of axes that
/// splits further if they are not independent (a chequered pattern gains nothing at first). Deterministic for
/// any number of threads. Cost: about 6 ns a ray and level; no memory beside the nodes.
/// `trees` of the numbers `tree_number` and on at once: what they have in common, their largest nodes, is
/// made once.
std::vector<GrownTree> grow_trees(std::span<TreeItem> items, const TreeBox& box, const GrowOptions& options,
                                  std::size_t trees);

/// Keeps the subtrees whose splits gain `penalty_nats` each on average (weakest-link pruning, L. Breiman et
/// al., "Classification and Regression Trees", 1984) and settles the shares in stored steps.
DensityTree prune_tree(const GrownTree& grown, double penalty_nats);

/// A tree without the rounding of its file: nodes whose steps say nothing but which sides are empty, and the
/// shares of the leaves in preorder; their sum is 1.
struct PrunedTree {
  DensityTree tree;
  std::vector<double> leaf_shares;
};

/// As prune_tree, before shares are settled.
PrunedTree prune_exactly(const GrownTree& grown, double penalty_nats);

/// Settles the shares in stored steps.
DensityTree settled(PrunedTree pruned);

/// Splits that prune_tree would keep; O(nodes).
std::size_t retained_splits(const GrownTree& grown, double penalty_nats);

/// Density of `tree` (1 / volume of the box's numbers) at a point; 0 outside the box. O(depth).
double tree_density(const DensityTree& tree, const TreeBox& box, const std::array<double, 4>& c);

/// A tree made ready for look-up: one comparison a level.
class TreeLookup {
 public:
  TreeLookup(const DensityTree& tree, const TreeBox& box);
  /// As tree_density.
  double density(const std::array<double, 4>& c) const;
  /// Adds the density at each point to `sum`: eight ways down at once, so that none waits for the others.
  void add_densities(std::span<const std::array<double, 4>> points, std::span<double> sum) const;

  /// In preorder, as TreeNode: `value` is a cut's place, or a leaf's (right == 0) density. The left child is
  /// `left` nodes further on: 1, but 0 at a leaf.
  struct Node {
    double value = 0.0;
    std::uint32_t right = 0;
    std::uint16_t left = 0, axis = 0;
  };
  std::span<const Node> nodes() const { return nodes_; }

 private:
  TreeBox box_;
  std::vector<Node> nodes_;
};

}  // namespace lucerna
