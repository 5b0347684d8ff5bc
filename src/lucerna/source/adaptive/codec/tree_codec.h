// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/source/adaptive/codec/range_coder.h"
#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

/// Codes trees node by node in preorder: is it a leaf, which axis, which cut, which step; each with
/// probabilities that depend on the rays in the node and the split above it (docs/reference/nfl-adaptive.md).
/// About 12 bits a leaf. The same object must see the same trees in the same order on both sides.
class TreeCodec {
 public:
  /// `tree_number` as the tree was grown with; it foretells the offered cuts.
  void encode(RangeEncoder& coder, const DensityTree& tree, std::uint64_t tree_number);

  /// Fills `nodes` for a tree of `rays`; `max_nodes` bounds them. False if the bytes end or make no tree.
  bool decode(RangeDecoder& coder, double rays, std::uint64_t tree_number, std::size_t max_nodes,
              std::vector<TreeNode>& nodes);

 private:
  /// What is known of a node before it is coded.
  struct Context {
    std::uint64_t path = kRootPath;
    double rays = 0.0;
    std::uint32_t size = 0;        // log2 of the rays, 0..31
    std::uint32_t axis_above = 4;  // 4 = root
    bool upper = false;
  };
  template <class Side>
  void node(Side& side, TreeNode& n, const Context& c, std::uint64_t tree_number);
  static Context child(const Context& c, const TreeNode& n, bool upper);
  static Context root(double rays);

  struct Encode;
  struct Decode;
  std::array<std::array<AdaptiveBit, 3>, 32> split_;
  std::array<AdaptiveSymbol<2>, 5> axis_;
  std::array<std::array<AdaptiveSymbol<2>, 2>, 4> fine_cut_;
  std::array<AdaptiveSymbol<4>, 4> cut_;
  std::array<std::array<AdaptiveBit, 3>, 4> empty_;
  std::array<std::array<AdaptiveBit, 2>, 4> sign_;
  std::array<std::array<AdaptiveBit, 13>, 4> length_;
  std::array<std::array<std::array<AdaptiveBit, 2>, 13>, 4> mantissa_;
  std::array<AdaptiveBit, 13> rest_;
};

}  // namespace lucerna
