// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/tree/adaptive_tree.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/adaptive/tree/split_items.h"
#include "lucerna/source/adaptive/tree/tree_counts.h"

namespace lucerna {

namespace {

constexpr std::size_t kParallelItems = 1 << 15, kHistogramBlock = 1 << 19;
/// Fewer effective rays than this are never split.
constexpr double kSmallestNode = 6.0;
/// Above so many rays every one of the 63 cuts is tried.
constexpr std::size_t kAllCuts = 20000;
/// Nats by which a cut that is not offered must beat those that are: only sharp edges do.
constexpr double kSharpEdge = 2.0;
/// Small nodes offer one in so many cuts.
constexpr std::uint32_t kOfferStride = 4;
/// Splits in a row that may gain nothing, after the test on pairs of axes.
constexpr int kBlindSplits = 6;
/// Edges are not cut below this share of the first box, nor to where float32 runs out.
constexpr double kFinest = 0x1p-17, kFloatSteps = 0x1p-19;

/// Counts of all items; parts of a large node are counted on all threads.
TreeCounts count(std::span<const TreeItem> items, const TreeBinning& binning) {
  TreeCounts sum;
  if (items.size() <= kHistogramBlock) {
    count_items(items, binning, sum);
    return sum;
  }
  const auto parts =
      parallel_map_blocks<TreeCounts>(items.size(), kHistogramBlock, [&](std::size_t a, std::size_t b) {
        TreeCounts c;
        count_items(items.subspan(a, b - a), binning, c);
        return c;
      });
  for (const TreeCounts& part : parts) sum.add(part);
  return sum;
}

struct Cut {
  double gain_nats = 0.0;
  std::uint32_t axis = 0, cut = 0;
};

using Nodes = std::vector<GrownTree::Node>;

struct TreeGrower {
  TreeBox root;
  GrowOptions options;

  bool may_cut(const TreeBox& box, std::size_t d) const {
    const double size = std::max(std::abs(box.low[d]), std::abs(box.high[d]));
    return box.width(d) > std::max(kFinest * root.width(d), kFloatSteps * size);
  }

  Cut best_cut(const TreeSums& below, double scale, const TreeBox& box, std::uint64_t path,
               std::uint64_t tree, bool all, std::uint32_t axes) const {
    const double weight = below[kTreeCuts][0];
    const std::uint32_t stride = all ? 1 : kOfferStride;
    CutList cuts;
    std::array<Cut, CutList::kMax> which;
    for (std::uint32_t d = 0; d < 4; ++d) {
      if ((axes >> d & 1u) == 0 || !may_cut(box, d)) continue;
      const std::uint32_t offset = all ? 1 : 1 + cut_offset(tree, path, d);
      for (std::uint32_t cut = offset; cut < kTreeCuts; cut += stride) {
        which[cuts.size] = {0.0, d, cut};
        cuts.add(below[cut][d], cut);
      }
    }
    if (cuts.size == 0) return {};
    const std::size_t max = count_gains(weight, cuts);
    if (!(cuts.gain[max] > 0.0)) return {};
    Cut best = which[max];
    best.gain_nats = cuts.gain[max] * scale;
    return all ? best : sharper(below, scale, best);
  }

  /// The best of the cuts beside one that was offered, if it is much better: a sharp edge lies there.
  static Cut sharper(const TreeSums& below, double scale, const Cut& offered) {
    constexpr std::uint32_t kBeside = kOfferStride - 1;
    const std::uint32_t first = offered.cut > kBeside ? offered.cut - kBeside : 1;
    CutList cuts;
    for (std::uint32_t cut = first; cut < kTreeCuts && cut <= offered.cut + kBeside; ++cut) {
      cuts.add(below[cut][offered.axis], cut);
    }
    const std::size_t max = count_gains(below[kTreeCuts][0], cuts);
    const double gain = cuts.gain[max] * scale;
    if (!(gain > offered.gain_nats + kSharpEdge)) return offered;
    return {gain, offered.axis, first + static_cast<std::uint32_t>(max)};
  }

  /// The axis to split in the middle because it is not independent of another; none below 300 rays.
  std::uint32_t dependent_axis(std::span<const TreeItem> items, const TreeBinning& binning, double scale,
                               double rays, const TreeBox& box) const;

  /// Where a node is, and how many more splits may gain nothing.
  struct Place {
    std::uint64_t path;
    int blind;
  };
  struct Choice {
    double weight;
    Cut cut;
    int blind;
    bool splits;
  };
  /// Not inlined: its counts shall not lie on the stack of the recursion.
  [[gnu::noinline]] Choice choose(std::span<const TreeItem> items, const TreeBox& box, const Place& at,
                                  std::uint64_t tree) const;

  /// Grows trees first_tree, first_tree + 1 ... below a node, one for each `out`. Large nodes offer all cuts
  /// to all, so they are the same in all and made once.
  void grow(std::span<TreeItem> items, const TreeBox& box, const Place& at, std::uint64_t first_tree,
            std::span<Nodes> out) const;
};

constexpr std::uint32_t kNoAxis = 4;

/// How far a table of `rows` x `columns` weights is from the product of its margins, in standard deviations
/// of the likelihood ratio's chi-square.
double dependence(const std::vector<double>& table, std::size_t rows, std::size_t columns, double scale) {
  std::vector<double> row(rows, 0.0), column(columns, 0.0);
  double total = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      row[i] += table[i * columns + j];
      column[j] += table[i * columns + j];
      total += table[i * columns + j];
    }
  }
  double g = 0.0;
  const auto used = [](const std::vector<double>& v) {
    return static_cast<double>(std::count_if(v.begin(), v.end(), [](double x) { return x > 0.0; }));
  };
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) {
      // Pearson's form: unlike the likelihood ratio it is not biased by cells of few rays.
      const double expected = row[i] * column[j] / total;
      if (expected <= 0.0) continue;
      const double difference = table[i * columns + j] - expected;
      g += difference * difference / expected;
    }
  }
  const double freedom = std::max(1.0, (used(row) - 1.0) * (used(column) - 1.0));
  return (g * scale - freedom) / std::sqrt(2.0 * freedom);
}

/// Adds up `by` neighbouring columns.
std::vector<double> coarser(const std::vector<double>& table, std::size_t rows, std::size_t columns,
                            std::size_t by) {
  std::vector<double> sum(rows * (columns / by), 0.0);
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < columns; ++j) sum[i * (columns / by) + j / by] += table[i * columns + j];
  }
  return sum;
}

std::uint32_t TreeGrower::dependent_axis(std::span<const TreeItem> items, const TreeBinning& binning,
                                         double scale, double rays, const TreeBox& box) const {
  constexpr double kMin = 300.0, kSome = 2000.0, kMany = 20000.0, kSignificant = 6.0;
  if (rays < kMin) return kNoAxis;
  const std::size_t shift = rays < kSome ? 3 : rays < kMany ? 2 : 1, bins = kTreeCuts >> shift, coarse = 4;
  double max = kSignificant;
  std::uint32_t axis = kNoAxis;
  for (std::uint32_t a = 0; a < 4; ++a) {
    for (std::uint32_t b = a + 1; b < 4; ++b) {
      if (!may_cut(box, a) || !may_cut(box, b)) continue;
      std::vector<double> table(bins * bins, 0.0), turned(bins * bins);
      for (const TreeItem& item : items) {
        table[(binning.bin(item, a) >> shift) * bins + (binning.bin(item, b) >> shift)] +=
            static_cast<double>(item.weight);
      }
      const double found = dependence(table, bins, bins, scale);
      if (found <= max) continue;
      max = found;
      for (std::size_t i = 0; i < bins; ++i) {
        for (std::size_t j = 0; j < bins; ++j) turned[j * bins + i] = table[i * bins + j];
      }
      // Split the axis along which the pattern is the coarser of the two.
      const double coarse_b = dependence(coarser(table, bins, bins, coarse), bins, bins / coarse, scale);
      const double coarse_a = dependence(coarser(turned, bins, bins, coarse), bins, bins / coarse, scale);
      axis = coarse_b > coarse_a ? b : a;
    }
  }
  return axis;
}

TreeGrower::Choice TreeGrower::choose(std::span<const TreeItem> items, const TreeBox& box, const Place& at,
                                      std::uint64_t tree) const {
  const TreeBinning binning(box);
  const TreeCounts counts = count(items, binning);
  const TreeSums below = sums_below(counts);
  Choice choice{below[kTreeCuts][0], {}, at.blind, false};
  if (counts.squares <= 0.0 || choice.weight * choice.weight < kSmallestNode * counts.squares) return choice;
  const double scale = choice.weight / counts.squares;
  const bool all = tree < options.fine_trees || items.size() > kAllCuts;
  choice.cut = best_cut(below, scale, box, at.path, tree, all, options.first_axes);
  if (options.first_axes != kAllAxes && choice.cut.gain_nats < options.penalty_nats)
    choice.cut = best_cut(below, scale, box, at.path, tree, all, kAllAxes);
  choice.splits = true;
  if (choice.cut.gain_nats >= options.penalty_nats) {
    choice.blind = kBlindSplits;
    return choice;
  }
  const double rays = choice.weight * scale;
  const std::uint32_t axis = at.blind > 0 ? dependent_axis(items, binning, scale, rays, box) : kNoAxis;
  choice.splits = axis != kNoAxis;
  if (choice.cut.axis != axis || choice.cut.gain_nats <= 0.0) choice.cut = {0.0, axis, kTreeCuts / 2};
  --choice.blind;
  return choice;
}

void TreeGrower::grow(std::span<TreeItem> items, const TreeBox& box, const Place& at,
                      std::uint64_t first_tree, std::span<Nodes> out) const {
  if (out.size() > 1 && items.size() <= kAllCuts) {
    for (std::size_t t = 0; t < out.size(); ++t) grow(items, box, at, first_tree + t, out.subspan(t, 1));
    return;
  }
  std::vector<std::size_t> self;
  const Choice choice = choose(items, box, at, first_tree);
  for (Nodes& nodes : out) {
    self.push_back(nodes.size());
    nodes.emplace_back().weight = choice.weight;
  }
  if (!choice.splits) return;
  const Cut& cut = choice.cut;
  const TreeBinning binning(box);
  const auto edge = static_cast<float>(cut.cut);
  const std::size_t middle =
      split_items(items, [&](const TreeItem& item) { return binning.place(item, cut.axis) < edge; });
  const auto grow_half = [&](bool upper, std::span<Nodes> to) {
    grow(upper ? items.subspan(middle) : items.first(middle), box.half(cut.axis, cut.cut, upper),
         {child_path(at.path, upper), choice.blind}, first_tree, to);
  };
  std::vector<Nodes> right(items.size() < kParallelItems ? 0 : out.size());
  if (right.empty())
    grow_half(false, out);
  else
    parallel_invoke([&] { grow_half(false, out); }, [&] { grow_half(true, right); });
  for (std::size_t t = 0; t < out.size(); ++t) {
    GrownTree::Node& node = out[t][self[t]];
    node.right = static_cast<std::uint32_t>(out[t].size() - self[t]);
    node.axis = static_cast<std::uint8_t>(cut.axis);
    node.cut = static_cast<std::uint8_t>(cut.cut);
    node.gain_nats = static_cast<float>(cut.gain_nats);
    if (!right.empty()) out[t].insert(out[t].end(), right[t].begin(), right[t].end());
  }
  if (right.empty()) grow_half(true, out);
}

}  // namespace

TreeBox TreeBox::half(std::uint32_t axis, std::uint32_t cut, bool upper) const {
  TreeBox part = *this;
  const double place = low[axis] + (high[axis] - low[axis]) * (cut * (1.0 / kTreeCuts));
  (upper ? part.low : part.high)[axis] = place;
  return part;
}

double TreeBox::volume() const {
  double v = 1.0;
  for (std::size_t d = 0; d < 4; ++d) {
    if (width(d) > 0.0) v *= width(d);
  }
  return v;
}

std::vector<GrownTree> grow_trees(std::span<TreeItem> items, const TreeBox& box, const GrowOptions& options,
                                  std::size_t trees) {
  std::vector<Nodes> nodes(trees);
  TreeGrower{box, options}.grow(items, box, {kRootPath, kBlindSplits}, options.tree_number, nodes);
  double squares = 0.0;
  for (const TreeItem& item : items)
    squares += static_cast<double>(item.weight) * static_cast<double>(item.weight);
  std::vector<GrownTree> grown(trees);
  for (std::size_t t = 0; t < trees; ++t) {
    const double weight = nodes[t].front().weight;
    grown[t] = {std::move(nodes[t]), weight, squares > 0.0 ? weight * weight / squares : 0.0};
  }
  return grown;
}

double tree_density(const DensityTree& tree, const TreeBox& box, const std::array<double, 4>& c) {
  for (std::size_t d = 0; d < 4; ++d) {
    if (c[d] < box.low[d] || c[d] > box.high[d]) return 0.0;
  }
  TreeBox b = box;
  double share = 1.0;
  std::size_t i = 0;
  while (!tree.nodes[i].is_leaf()) {
    const TreeNode& n = tree.nodes[i];
    const double left = tree_share(n, tree.rays * share);
    const TreeBox upper = b.half(n.axis, n.cut, true);
    if (c[n.axis] >= upper.low[n.axis]) {
      b = upper, share *= 1.0 - left, i += n.right;
    } else {
      b = b.half(n.axis, n.cut, false), share *= left, i += 1;
    }
  }
  return share / b.volume();
}

TreeLookup::TreeLookup(const DensityTree& tree, const TreeBox& box) : box_(box), nodes_(tree.nodes.size()) {
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
      nodes_[p.node].value = p.share / p.box.volume();
      continue;
    }
    const TreeBox upper = p.box.half(n.axis, n.cut, true);
    nodes_[p.node] = {upper.low[n.axis], n.right, 1, n.axis};
    const double left = tree_share(n, tree.rays * p.share);
    stack.push_back({p.node + n.right, upper, p.share * (1.0 - left)});
    stack.push_back({p.node + 1, p.box.half(n.axis, n.cut, false), p.share * left});
  }
}

double TreeLookup::density(const std::array<double, 4>& c) const {
  for (std::size_t d = 0; d < 4; ++d) {
    if (c[d] < box_.low[d] || c[d] > box_.high[d]) return 0.0;
  }
  const Node* n = nodes_.data();
  while (n->right != 0) n += c[n->axis] >= n->value ? n->right : 1;
  return n->value;
}

void TreeLookup::add_densities(std::span<const std::array<double, 4>> points, std::span<double> sum) const {
  constexpr std::size_t kWays = 8;
  std::size_t first = 0;
  for (; first + kWays <= points.size(); first += kWays) {
    std::array<const Node*, kWays> at;
    at.fill(nodes_.data());
    for (std::uint32_t links = 1; links != 0;) {
      links = 0;
      for (std::size_t k = 0; k < kWays; ++k) {
        const Node& n = *at[k];
        // A mask instead of a choice, of which compilers make a branch that no processor can foretell.
        const std::uint32_t up = points[first + k][n.axis] >= n.value ? 1 : 0;
        at[k] += n.left + ((n.right - n.left) & (0u - up));
        links |= n.right;
      }
    }
    for (std::size_t k = 0; k < kWays; ++k) {
      const auto& c = points[first + k];
      bool inside = true;
      for (std::size_t d = 0; d < 4; ++d) inside = inside && c[d] >= box_.low[d] && c[d] <= box_.high[d];
      sum[first + k] += inside ? at[k]->value : 0.0;
    }
  }
  for (; first < points.size(); ++first) sum[first] += density(points[first]);
}

}  // namespace lucerna
