// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive_tree.h"

#include <oneapi/tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>

#include "lucerna/core/parallel.h"

namespace lucerna {

namespace {

constexpr std::size_t kParallelItems = 1 << 15, kHistogramBlock = 1 << 19;
/// Fewer effective rays than this are never split.
constexpr double kSmallestNode = 6.0;
/// Effective rays from which every one of the 63 cuts is tried.
constexpr double kAllCuts = 20000.0;
/// Nats by which a cut that is not offered must beat those that are: only sharp edges do.
constexpr double kSharpEdge = 2.0;
/// Splits in a row that may gain nothing, after the test on pairs of axes.
constexpr int kBlindSplits = 6;
/// Edges are not cut below this share of the first box, nor to where float32 runs out.
constexpr double kFinest = 0x1p-17, kFloatSteps = 0x1p-19;
/// A child is stored as empty when it should have had so many rays and has none.
constexpr double kSurelyEmpty = 8.0;
/// Weight of the volume beside the rays in a share, in rays: keeps every leaf's density > 0.
constexpr double kPrior = 0.5;

using Histogram = std::array<std::array<double, kTreeCuts>, 4>;

struct Binning {
  std::array<float, 4> low{}, scale{};

  explicit Binning(const TreeBox& box) {
    for (std::size_t d = 0; d < 4; ++d) {
      low[d] = static_cast<float>(box.low[d]);
      const double width = box.width(d);
      scale[d] = width > 0.0 ? static_cast<float>(kTreeCuts / width) : 0.0f;
    }
  }
  std::uint32_t bin(const TreeItem& item, std::size_t d) const {
    const int i = static_cast<int>((item.c[d] - low[d]) * scale[d]);
    return static_cast<std::uint32_t>(std::clamp(i, 0, static_cast<int>(kTreeCuts) - 1));
  }
};

struct Counts {
  Histogram bins{};
  double weight = 0.0, squares = 0.0;

  void add(std::span<const TreeItem> items, const Binning& binning) {
    for (const TreeItem& item : items) {
      const double w = static_cast<double>(item.weight);
      for (std::size_t d = 0; d < 4; ++d) bins[d][binning.bin(item, d)] += w;
      weight += w;
      squares += w * w;
    }
  }
  void add(const Counts& other) {
    for (std::size_t d = 0; d < 4; ++d) {
      for (std::size_t b = 0; b < kTreeCuts; ++b) bins[d][b] += other.bins[d][b];
    }
    weight += other.weight;
    squares += other.squares;
  }
};

Counts count(std::span<const TreeItem> items, const Binning& binning) {
  if (items.size() <= kHistogramBlock) {
    Counts c;
    c.add(items, binning);
    return c;
  }
  const auto parts =
      parallel_map_blocks<Counts>(items.size(), kHistogramBlock, [&](std::size_t a, std::size_t b) {
        Counts c;
        c.add(items.subspan(a, b - a), binning);
        return c;
      });
  Counts sum;
  for (const Counts& part : parts) sum.add(part);
  return sum;
}

struct Cut {
  double gain_nats = 0.0;
  std::uint32_t axis = 0, cut = 0;
};

double n_log_ratio(double n, double expected) { return n > 0.0 ? n * std::log(n / expected) : 0.0; }

struct Grower {
  TreeBox root;
  GrowOptions options;

  bool may_cut(const TreeBox& box, std::size_t d) const {
    const double size = std::max(std::abs(box.low[d]), std::abs(box.high[d]));
    return box.width(d) > std::max(kFinest * root.width(d), kFloatSteps * size);
  }

  static double gain_of(const Counts& c, std::uint32_t cut, double below) {
    const double f = cut * (1.0 / kTreeCuts);
    return n_log_ratio(below, c.weight * f) + n_log_ratio(c.weight - below, c.weight * (1.0 - f));
  }

  Cut best_cut(const Counts& c, const TreeBox& box, std::uint64_t path) const {
    const double scale = c.weight / c.squares, rays = c.weight * scale;
    const bool all = !options.coarse_cuts || rays > kAllCuts;
    const std::uint32_t stride = all ? 1 : 4;
    Cut best;
    for (std::uint32_t d = 0; d < 4; ++d) {
      if (!may_cut(box, d)) continue;
      const std::uint32_t offset = all ? 1 : 1 + cut_offset(options.tree_number, path, d);
      double below = 0.0;
      std::uint32_t summed = 0;
      for (std::uint32_t cut = offset; cut < kTreeCuts; cut += stride) {
        for (; summed < cut; ++summed) below += c.bins[d][summed];
        const double gain = gain_of(c, cut, below);
        if (gain * scale > best.gain_nats) best = {gain * scale, d, cut};
      }
    }
    return all || best.gain_nats <= 0.0 ? best : sharper(c, scale, best);
  }

  /// The best of the cuts beside one that was offered, if it is much better: a sharp edge lies there.
  static Cut sharper(const Counts& c, double scale, const Cut& offered) {
    constexpr std::uint32_t kBeside = 3;
    Cut best = offered;
    const std::uint32_t first = offered.cut > kBeside ? offered.cut - kBeside : 1;
    double below = 0.0;
    for (std::uint32_t b = 0; b < first; ++b) below += c.bins[offered.axis][b];
    for (std::uint32_t cut = first; cut < kTreeCuts && cut <= offered.cut + kBeside; ++cut) {
      const double gain = gain_of(c, cut, below) * scale;
      if (gain > best.gain_nats && gain > offered.gain_nats + kSharpEdge) best = {gain, offered.axis, cut};
      below += c.bins[offered.axis][cut];
    }
    return best;
  }

  /// The axis to split in the middle because it is not independent of another; none below 300 rays.
  std::uint32_t dependent_axis(std::span<const TreeItem> items, const Binning& binning, const Counts& c,
                               const TreeBox& box) const;

  void grow(std::span<TreeItem> items, const TreeBox& box, std::uint64_t path, int blind,
            std::vector<GrownTree::Node>& out) const;
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

std::uint32_t Grower::dependent_axis(std::span<const TreeItem> items, const Binning& binning, const Counts& c,
                                     const TreeBox& box) const {
  constexpr double kFewest = 300.0, kSome = 2000.0, kMany = 20000.0, kSignificant = 6.0;
  const double scale = c.weight / c.squares, rays = scale * c.weight;
  if (rays < kFewest) return kNoAxis;
  const std::size_t shift = rays < kSome ? 3 : rays < kMany ? 2 : 1, bins = kTreeCuts >> shift, coarse = 4;
  double most = kSignificant;
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
      if (found <= most) continue;
      most = found;
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

void Grower::grow(std::span<TreeItem> items, const TreeBox& box, std::uint64_t path, int blind,
                  std::vector<GrownTree::Node>& out) const {
  const std::size_t self = out.size();
  out.emplace_back();
  const Binning binning(box);
  const Counts counts = count(items, binning);
  out[self].weight = counts.weight;
  if (counts.squares <= 0.0 || counts.weight * counts.weight < kSmallestNode * counts.squares) return;
  Cut cut = best_cut(counts, box, path);
  if (cut.gain_nats < options.penalty_nats) {
    const std::uint32_t axis = blind > 0 ? dependent_axis(items, binning, counts, box) : kNoAxis;
    if (axis == kNoAxis) return;
    if (cut.axis != axis || cut.gain_nats <= 0.0) cut = {0.0, axis, kTreeCuts / 2};
    --blind;
  } else {
    blind = kBlindSplits;
  }
  const auto middle = std::partition(items.begin(), items.end(), [&](const TreeItem& item) {
    return binning.bin(item, cut.axis) < cut.cut;
  });
  const std::span<TreeItem> lower(items.begin(), middle), upper(middle, items.end());
  const TreeBox low_box = box.half(cut.axis, cut.cut, false), high_box = box.half(cut.axis, cut.cut, true);
  const std::uint64_t low_path = child_path(path, false), high_path = child_path(path, true);
  if (items.size() < kParallelItems) {
    grow(lower, low_box, low_path, blind, out);
    out[self].right = static_cast<std::uint32_t>(out.size() - self);
    grow(upper, high_box, high_path, blind, out);
  } else {
    std::vector<GrownTree::Node> right;
    oneapi::tbb::parallel_invoke([&] { grow(lower, low_box, low_path, blind, out); },
                                 [&] { grow(upper, high_box, high_path, blind, right); });
    out[self].right = static_cast<std::uint32_t>(out.size() - self);
    out.insert(out.end(), right.begin(), right.end());
  }
  out[self].axis = static_cast<std::uint8_t>(cut.axis);
  out[self].cut = static_cast<std::uint8_t>(cut.cut);
  out[self].gain_nats = static_cast<float>(cut.gain_nats);
}

/// Gain and splits of each node's subtree once what does not pay is gone; 0 splits = becomes a leaf.
std::vector<std::uint32_t> splits_kept_below(const GrownTree& grown, double penalty_nats) {
  const std::size_t n = grown.nodes.size();
  std::vector<double> gain(n, 0.0);
  std::vector<std::uint32_t> splits(n, 0);
  for (std::size_t i = n; i-- > 0;) {
    const auto& node = grown.nodes[i];
    if (node.right == 0) continue;
    gain[i] = static_cast<double>(node.gain_nats) + gain[i + 1] + gain[i + node.right];
    splits[i] = 1 + splits[i + 1] + splits[i + node.right];
    if (gain[i] < penalty_nats * splits[i]) gain[i] = 0.0, splits[i] = 0;
  }
  return splits;
}

/// e^x for |x| < 700 from additions and multiplications alone: the same bits everywhere.
double exact_exp(double x) {
  constexpr double kLn2 = 0.69314718055994530942;
  const double k = std::floor(x / kLn2 + 0.5), r = (x - k * kLn2) * 0.125;
  double e = 1.0;
  for (int i = 12; i > 0; --i) e = 1.0 + e * r / i;
  e *= e, e *= e, e *= e;
  return std::ldexp(e, static_cast<int>(k));
}

double step_width(double f, double rays) {
  constexpr double kFinestStep = 1.0 / 256.0;
  return std::max(kFinestStep, 1.0 / std::sqrt(std::max(1.0, rays * f * (1.0 - f))));
}

std::int16_t settled_step(const GrownTree& grown, std::size_t i, double rays) {
  const auto& node = grown.nodes[i];
  const double f = node.cut * (1.0 / kTreeCuts), scale = grown.effective_rays / grown.total_weight;
  const double left = scale * grown.nodes[i + 1].weight, right = scale * grown.nodes[i + node.right].weight;
  const double all = left + right;
  if (left <= 0.0 && all * f > kSurelyEmpty) return kLeftEmpty;
  if (right <= 0.0 && all * (1.0 - f) > kSurelyEmpty) return kRightEmpty;
  const double p = (left + kPrior * f) / (all + kPrior);
  const double log_odds = std::log(p / (1.0 - p)) - std::log(f / (1.0 - f));
  const double steps = std::round(log_odds / step_width(f, rays));
  return static_cast<std::int16_t>(std::clamp<double>(steps, -kLargestStep, kLargestStep));
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

double tree_share(const TreeNode& node, double rays) {
  if (node.step == kLeftEmpty) return 0.0;
  if (node.step == kRightEmpty) return 1.0;
  const double f = node.cut * (1.0 / kTreeCuts);
  const double e = exact_exp(std::clamp(node.step * step_width(f, rays), -60.0, 60.0));
  return f * e / (f * e + 1.0 - f);
}

GrownTree grow_tree(std::span<TreeItem> items, const TreeBox& box, const GrowOptions& options) {
  GrownTree tree;
  const Grower grower{box, options};
  grower.grow(items, box, kRootPath, kBlindSplits, tree.nodes);
  tree.total_weight = tree.nodes[0].weight;
  double squares = 0.0;
  for (const TreeItem& item : items)
    squares += static_cast<double>(item.weight) * static_cast<double>(item.weight);
  tree.effective_rays = squares > 0.0 ? tree.total_weight * tree.total_weight / squares : 0.0;
  return tree;
}

std::size_t kept_splits(const GrownTree& grown, double penalty_nats) {
  return splits_kept_below(grown, penalty_nats)[0];
}

DensityTree prune_tree(const GrownTree& grown, double penalty_nats) {
  const auto splits = splits_kept_below(grown, penalty_nats);
  DensityTree tree;
  tree.rays = grown.effective_rays;
  tree.nodes.resize(2 * static_cast<std::size_t>(splits[0]) + 1);
  struct Pending {
    std::size_t from, to;
    double share;
  };
  std::vector<Pending> stack{{0, 0, 1.0}};
  while (!stack.empty()) {
    const Pending p = stack.back();
    stack.pop_back();
    if (splits[p.from] == 0) continue;
    const auto& node = grown.nodes[p.from];
    TreeNode& kept = tree.nodes[p.to];
    kept.right = 2 + 2 * splits[p.from + 1];
    kept.axis = node.axis;
    kept.cut = node.cut;
    kept.step = settled_step(grown, p.from, tree.rays * p.share);
    const double left = tree_share(kept, tree.rays * p.share);
    stack.push_back({p.from + node.right, p.to + kept.right, p.share * (1.0 - left)});
    stack.push_back({p.from + 1, p.to + 1, p.share * left});
  }
  return tree;
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
    bool down = true;
    while (down) {
      down = false;
      for (std::size_t k = 0; k < kWays; ++k) {
        const Node& n = *at[k];
        at[k] += points[first + k][n.axis] >= n.value ? n.right : n.left;
        down = down || n.right != 0;
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
