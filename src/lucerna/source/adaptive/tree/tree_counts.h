// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

/// Which of the kTreeCuts equal parts of a box's edges an item lies in.
struct TreeBinning {
  std::array<float, 4> low{}, scale{};

  explicit TreeBinning(const TreeBox& box);
  /// Place along edge `d` in parts; may step over 0 or kTreeCuts by rounding.
  float place(const TreeItem& item, std::size_t d) const { return (item.c[d] - low[d]) * scale[d]; }
  std::uint32_t bin(const TreeItem& item, std::size_t d) const;
};

/// Weight in the parts of a box: bins[part][axis], so that four axes are added at once.
struct TreeCounts {
  using Row = std::array<double, 4>;
  alignas(64) std::array<Row, kTreeCuts> bins{};
  double squares = 0.0;  // sum of the squared weights

  void add(const TreeCounts& other);
};

/// Adds `items` to `counts`. About 2 ns an item.
void count_items(std::span<const TreeItem> items, const TreeBinning& binning, TreeCounts& counts);

/// Weight below every cut: row k is below cut k, the last row is all of it.
using TreeSums = std::array<TreeCounts::Row, kTreeCuts + 1>;
TreeSums sums_below(const TreeCounts& counts);

/// Cuts of which the gain is wanted, for count_gains: lanes that are not used gain nothing.
struct CutList {
  static constexpr std::size_t kMax = std::size_t{4} * kTreeCuts;
  std::size_t size = 0;
  alignas(64) std::array<double, kMax> below, log_below, log_above, gain;

  /// The next lane: the weight below cut `cut`. 0 and kTreeCuts are no cuts and gain nothing.
  void add(double weight_below, std::uint32_t cut);
};

/// Log likelihood that each cut gains, in nats times weight: with the share f of the volume below,
/// n_1 ln(n_1 / (n f)) + n_2 ln(n_2 / (n (1 - f))). Returns the first lane of the largest. About 2 ns a cut.
std::size_t count_gains(double weight, CutList& cuts);

}  // namespace lucerna
