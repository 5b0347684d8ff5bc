// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

/// A pair of a chart's four numbers, over which light is summed along the other two, in side x side cells of
/// the chart's box; side = 2^bits.
struct AxisPair {
  std::uint32_t first = 0, second = 1, bits = 7;
  std::size_t side() const { return std::size_t{1} << bits; }
};

/// Place (0, 1) and direction (2, 3), and coarsely how they hang together.
inline constexpr std::array<AxisPair, 6> kAxisPairs{
    {{0, 1, 7}, {2, 3, 7}, {0, 2, 5}, {0, 3, 5}, {1, 2, 5}, {1, 3, 5}}};

/// Where along an edge of a chart's box most light is: that part, an edge from 0 to 1, is stretched to nearly
/// all of the cells, linear within and to either side.
struct CoreStretch {
  double low = 0.0, high = 1.0;
  /// Of the stretched edge on either side.
  static constexpr double kMargin = 1.0 / 32.0;
  double stretched(double t) const {
    if (t < low) return kMargin * t / low;
    if (t > high) return 1.0 - kMargin * (1.0 - t) / (1.0 - high);
    return kMargin + (1.0 - 2.0 * kMargin) * (t - low) / (high - low);
  }
};

/// What a chart's rays sum to in the cells of every pair of axes: statistics that add, of any number of rays.
class TreeMarginals {
 public:
  /// Cells of one pair, `second` running fastest.
  struct Cells {
    std::vector<double> weight, squares;
  };

  TreeMarginals(std::span<const TreeItem> items, const TreeBox& box);

  /// Adds rays of the same chart. On all threads, the same bits for any number of them. About 10 ns a ray.
  void add(std::span<const TreeItem> items);
  /// Takes all rays away, and leaves the cells where they are.
  void clear();

  const Cells& cells(std::size_t pair) const { return cells_[pair]; }
  const std::array<CoreStretch, 4>& stretch() const { return stretch_; }
  double total_weight() const { return total_weight_; }
  /// Sum of the squared weights of all rays.
  double total_squares() const { return total_squares_; }

 private:
  void find_cores(std::span<const TreeItem> items);

  TreeBox box_;
  std::array<Cells, kAxisPairs.size()> cells_;
  std::array<CoreStretch, 4> stretch_;
  double total_weight_ = 0.0, total_squares_ = 0.0;
};

/// Shares of cells that are nearest to what `rays` show while they differ from those of a model (`model`,
/// sums to 1) by no more than noise: along binary hierarchies of the cells, coarse to fine, how each node's
/// light is divided is moved from the model's towards the rays' by James and Stein's factor, in blocks of
/// sixteen neighbours. Three hierarchies: first by rows, first by columns, by quarters. Equal to `model`
/// where the rays do not contradict it.
std::vector<double> shrunken_shares(const TreeMarginals::Cells& rays, double total_weight,
                                    double total_squares, const std::vector<double>& model,
                                    std::uint32_t bits);

/// Standard deviations of chi-square by which the rays contradict the model in their sums along one axis of a
/// pair: the worst of both axes, all scales and blocks of sixteen neighbours.
double axis_contradiction(const TreeMarginals::Cells& rays, double total_weight, double total_squares,
                          const std::vector<double>& model, std::uint32_t bits);

}  // namespace lucerna
