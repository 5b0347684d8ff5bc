// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/leaf_calibration.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// A leaf's box on two axes, in cells.
struct LeafRectangle {
  std::array<double, 2> low, high;
};

/// Sums of leaves over a pair of axes, exactly: each leaf is sixteen numbers, whatever its size, and the rest
/// is sums along rows and columns.
class RectangleSums {
 public:
  explicit RectangleSums(std::size_t side)
      : side_(side), stride_(side + 2), impulses_(stride_ * stride_, 0.0) {}

  void add(const LeafRectangle& r, double share) {
    const Ends a = ends(r.low[0], r.high[0]), b = ends(r.low[1], r.high[1]);
    for (std::size_t i = 0; i < 4; ++i) {
      double* row = impulses_.data() + a.at[i] * stride_;
      for (std::size_t j = 0; j < 4; ++j) row[b.at[j]] += share * a.part[i] * b.part[j];
    }
  }
  void add(const RectangleSums& other) {
    for (std::size_t i = 0; i < impulses_.size(); ++i) impulses_[i] += other.impulses_[i];
  }
  /// Shares of the cells.
  std::vector<double> cells() const {
    std::vector<double> sums = impulses_;
    for (std::size_t i = 0; i < stride_; ++i) {
      for (std::size_t j = 1; j < stride_; ++j) sums[i * stride_ + j] += sums[i * stride_ + j - 1];
    }
    for (std::size_t i = 1; i < stride_; ++i) {
      for (std::size_t j = 0; j < stride_; ++j) sums[i * stride_ + j] += sums[(i - 1) * stride_ + j];
    }
    std::vector<double> shares(side_ * side_);
    for (std::size_t i = 0; i < side_; ++i) {
      for (std::size_t j = 0; j < side_; ++j) shares[i * side_ + j] = std::max(0.0, sums[i * stride_ + j]);
    }
    return shares;
  }

 private:
  /// The second differences of what a length that is evenly filled gives to the cells.
  struct Ends {
    std::array<std::size_t, 4> at;
    std::array<double, 4> part;
  };
  Ends ends(double low, double high) const {
    Ends e;
    if (!(high > low)) {  // all in one cell
      const auto cell = std::min(side_ - 1, static_cast<std::size_t>(low));
      return {{cell, cell + 1, cell, cell}, {1.0, -1.0, 0.0, 0.0}};
    }
    const double height = 1.0 / (high - low);
    const auto put = [&](std::size_t k, double x, double sign) {
      const auto cell = std::min(side_, static_cast<std::size_t>(x));
      const double within = x - static_cast<double>(cell);
      e.at[k] = cell, e.part[k] = sign * (1.0 - within);
      e.at[k + 1] = cell + 1, e.part[k + 1] = sign * within;
    };
    put(0, low, height), put(2, high, -height);
    return e;
  }
  std::size_t side_, stride_;
  std::vector<double> impulses_;
};

/// Means of a number per cell over rectangles, from its sums below and to the left.
class RectangleMeans {
 public:
  RectangleMeans(const std::vector<double>& cells, std::size_t side)
      : side_(side), stride_(side + 1), sums_(stride_ * stride_, 0.0) {
    for (std::size_t i = 0; i < side; ++i) {
      double row = 0.0;
      for (std::size_t j = 0; j < side; ++j) {
        row += cells[i * side + j];
        sums_[(i + 1) * stride_ + j + 1] = sums_[i * stride_ + j + 1] + row;
      }
    }
  }
  double mean(const LeafRectangle& r) const {
    // A box without an edge is all in one cell.
    LeafRectangle wide = r;
    for (std::size_t k = 0; k < 2; ++k) {
      if (r.high[k] > r.low[k]) continue;
      wide.low[k] = std::min(static_cast<double>(side_ - 1), std::floor(r.low[k]));
      wide.high[k] = wide.low[k] + 1.0;
    }
    const double sum = below(wide.high[0], wide.high[1]) - below(wide.low[0], wide.high[1]) -
                       below(wide.high[0], wide.low[1]) + below(wide.low[0], wide.low[1]);
    return sum / ((wide.high[0] - wide.low[0]) * (wide.high[1] - wide.low[1]));
  }

 private:
  double below(double x, double y) const {
    const auto i = std::min(side_ - 1, static_cast<std::size_t>(x)),
               j = std::min(side_ - 1, static_cast<std::size_t>(y));
    const double u = x - static_cast<double>(i), v = y - static_cast<double>(j);
    const double* s = sums_.data() + i * stride_ + j;
    return (1.0 - u) * ((1.0 - v) * s[0] + v * s[1]) + u * ((1.0 - v) * s[stride_] + v * s[stride_ + 1]);
  }
  std::size_t side_, stride_;
  std::vector<double> sums_;
};

/// Leaves as boxes in the chart's box, each edge from 0 to 1.
using LeafBoxes = std::vector<TreeBox>;

LeafBoxes leaf_boxes(const DensityTree& tree, const TreeBox& box) {
  LeafBoxes boxes;
  TreeBox unit;
  for (std::size_t d = 0; d < 4; ++d) unit.high[d] = box.width(d) > 0.0 ? 1.0 : 0.0;
  for_each_leaf(tree, unit, [&](const TreeBox& leaf, double) { boxes.push_back(leaf); });
  return boxes;
}

std::vector<LeafBoxes> all_leaf_boxes(std::span<const DensityTree> trees, const TreeBox& box) {
  std::vector<LeafBoxes> boxes(trees.size());
  parallel_blocks(trees.size(), 1, [&](std::size_t t, std::size_t) { boxes[t] = leaf_boxes(trees[t], box); });
  return boxes;
}

/// A length on the stretched edge as pieces that are evenly filled.
struct Pieces {
  std::size_t n = 0;
  std::array<double, 3> low, high, part;
};

Pieces pieces_of(double low, double high, const CoreStretch& stretch, double side) {
  Pieces p;
  const std::array<double, 4> ends{low, std::clamp(stretch.low, low, high),
                                   std::clamp(stretch.high, low, high), high};
  if (!(high > low)) return {1, {side * stretch.stretched(low)}, {side * stretch.stretched(low)}, {1.0}};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(ends[k + 1] > ends[k])) continue;
    p.low[p.n] = side * stretch.stretched(ends[k]);
    p.high[p.n] = side * stretch.stretched(ends[k + 1]);
    p.part[p.n++] = (ends[k + 1] - ends[k]) / (high - low);
  }
  return p;
}

/// Calls `part(rectangle, share)` for the pieces of a leaf on a pair of axes; the shares sum to 1.
template <class Part>
void for_each_piece(const TreeBox& leaf, const AxisPair& pair, const std::array<CoreStretch, 4>& stretch,
                    const Part& part) {
  const auto side = static_cast<double>(pair.side());
  const Pieces a = pieces_of(leaf.low[pair.first], leaf.high[pair.first], stretch[pair.first], side);
  const Pieces b = pieces_of(leaf.low[pair.second], leaf.high[pair.second], stretch[pair.second], side);
  for (std::size_t i = 0; i < a.n; ++i) {
    for (std::size_t j = 0; j < b.n; ++j)
      part(LeafRectangle{{a.low[i], b.low[j]}, {a.high[i], b.high[j]}}, a.part[i] * b.part[j]);
  }
}

/// The mean of all trees, summed over the other two axes.
std::vector<double> sums_of_trees(const std::vector<LeafBoxes>& boxes,
                                  const std::array<CoreStretch, 4>& stretch,
                                  std::span<const std::vector<double>> leaf_shares, const AxisPair& pair) {
  const double part = 1.0 / static_cast<double>(boxes.size());
  auto sums =
      parallel_map_blocks<std::unique_ptr<RectangleSums>>(boxes.size(), 1, [&](std::size_t t, std::size_t) {
        auto of_tree = std::make_unique<RectangleSums>(pair.side());
        for (std::size_t i = 0; i < boxes[t].size(); ++i) {
          const double share = part * leaf_shares[t][i];
          if (!(share > 0.0)) continue;
          for_each_piece(boxes[t][i], pair, stretch,
                         [&](const LeafRectangle& r, double of_it) { of_tree->add(r, share * of_it); });
        }
        return of_tree;
      });
  for (std::size_t t = 1; t < sums.size(); ++t) sums[0]->add(*sums[t]);
  return sums[0]->cells();
}

/// Multiplies every leaf's share by the mean of `ratio` over it; trees stay normalised.
void multiply_leaves(const std::vector<LeafBoxes>& boxes, const std::array<CoreStretch, 4>& stretch,
                     const std::vector<double>& ratio, const AxisPair& pair,
                     std::span<std::vector<double>> leaf_shares) {
  const RectangleMeans means(ratio, pair.side());
  parallel_blocks(boxes.size(), 1, [&](std::size_t t, std::size_t) {
    double sum = 0.0;
    for (std::size_t i = 0; i < boxes[t].size(); ++i) {
      double mean = 0.0;
      for_each_piece(boxes[t][i], pair, stretch,
                     [&](const LeafRectangle& r, double of_it) { mean += of_it * means.mean(r); });
      sum += leaf_shares[t][i] *= mean;
    }
    for (double& share : leaf_shares[t]) share /= sum;
  });
}

/// Shares that the cells of every pair should have; empty where they have them already.
using Wanted = std::array<std::vector<double>, kAxisPairs.size()>;

Wanted wanted_shares(const std::vector<LeafBoxes>& boxes, const TreeBox& box, const TreeMarginals& rays,
                     std::span<const std::vector<double>> leaf_shares) {
  constexpr double kNothing = 1e-9;
  Wanted wanted;
  for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
    const AxisPair& pair = kAxisPairs[p];
    if (!(box.width(pair.first) > 0.0) && !(box.width(pair.second) > 0.0)) continue;
    const std::vector<double> model = sums_of_trees(boxes, rays.stretch(), leaf_shares, pair);
    std::vector<double> shares =
        shrunken_shares(rays.cells(p), rays.total_weight(), rays.total_squares(), model, pair.bits);
    double moved = 0.0;
    for (std::size_t i = 0; i < model.size(); ++i) moved += std::abs(shares[i] - model[i]);
    if (moved > kNothing) wanted[p] = std::move(shares);
  }
  return wanted;
}

}  // namespace

double divergence_nats(std::span<const std::vector<double>> from, std::span<const std::vector<double>> to) {
  double sum = 0.0;
  for (std::size_t t = 0; t < from.size(); ++t) {
    for (std::size_t i = 0; i < from[t].size(); ++i) {
      if (from[t][i] > 0.0) sum += from[t][i] * std::log(from[t][i] / to[t][i]);
    }
  }
  return sum / static_cast<double>(from.size());
}

std::array<double, 2> contradictions(std::span<const DensityTree> trees, const TreeBox& box,
                                     const TreeMarginals& rays,
                                     std::span<const std::vector<double>> leaf_shares) {
  const std::vector<LeafBoxes> boxes = all_leaf_boxes(trees, box);
  std::array<double, 2> worst{};
  for (std::size_t p = 0; p < worst.size(); ++p) {
    const AxisPair& pair = kAxisPairs[p];
    const std::vector<double> model = sums_of_trees(boxes, rays.stretch(), leaf_shares, pair);
    worst[p] = axis_contradiction(rays.cells(p), rays.total_weight(), rays.total_squares(), model, pair.bits);
  }
  return worst;
}

void calibrate_leaves(std::span<const DensityTree> trees, const TreeBox& box, const TreeMarginals& rays,
                      std::span<std::vector<double>> leaf_shares) {
  // Place and direction have the more passes: they are cut finely, and what they are by themselves shows
  // most.
  constexpr int kPasses = 12, kOtherPasses = 3;
  constexpr double kMostAtOnce = 3.0;
  const std::vector<LeafBoxes> boxes = all_leaf_boxes(trees, box);
  const Wanted wanted = wanted_shares(boxes, box, rays, leaf_shares);
  const std::vector<std::vector<double>> counted(leaf_shares.begin(), leaf_shares.end());
  for (int pass = 0; pass < kPasses; ++pass) {
    for (std::size_t p = 0; p < kAxisPairs.size(); ++p) {
      if (wanted[p].empty() || (p >= 2 && pass >= kOtherPasses)) continue;
      std::vector<double> ratio = sums_of_trees(boxes, rays.stretch(), leaf_shares, kAxisPairs[p]);
      for (std::size_t i = 0; i < ratio.size(); ++i) {
        const double share = ratio[i];
        ratio[i] = share > 0.0 ? std::clamp(wanted[p][i] / share, 1.0 / kMostAtOnce, kMostAtOnce) : 1.0;
      }
      multiply_leaves(boxes, rays.stretch(), ratio, kAxisPairs[p], leaf_shares);
    }
    if (divergence_nats(counted, leaf_shares) > kMaxDivergence_nats) return;
  }
}

}  // namespace lucerna
