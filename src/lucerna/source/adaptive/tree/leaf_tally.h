// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

/// What rays add up to in the nodes of a grown tree: statistics of any number of rays, of which only a part
/// is in memory at a time.
class LeafTally {
 public:
  LeafTally(const GrownTree& tree, const TreeBox& box);

  /// Counts more rays, which it reorders; one beyond the box counts for the leaf next to it. On all threads,
  /// the same bits for any number of them. About 0.1 us an item and core.
  void add(std::span<TreeItem> items);

  /// Gives `tree`, the one that this was made of, the weights of the rays that were counted instead of those
  /// it was grown with, and what each of its cuts gains by them. Changes nothing if they have no weight.
  void apply(GrownTree& tree) const;

 private:
  /// In preorder, as GrownTree's: items below `edge` go to the next node. 0 = leaf.
  struct Node {
    std::uint32_t right = 0, axis = 0;
    float edge = 0.0F;
  };
  void count(std::size_t leaf, const TreeItem& item);
  void add_below(std::size_t node, std::span<TreeItem> items);

  std::vector<Node> nodes_;
  /// By nodes; only leaves are counted.
  std::vector<double> weight_, squares_;
};

}  // namespace lucerna
