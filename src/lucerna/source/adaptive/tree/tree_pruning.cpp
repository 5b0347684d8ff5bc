// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

namespace {

/// A child is stored as empty when it should have had so many rays and has none.
constexpr double kSurelyEmpty = 8.0;
/// Weight of the volume beside the rays in a share, in rays: keeps every leaf's density > 0.
constexpr double kPrior = 0.5;

/// Gain and splits of each node's subtree once what does not pay is gone; 0 splits = becomes a leaf.
std::vector<std::uint32_t> splits_retained_below(const GrownTree& grown, double penalty_nats) {
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

/// The part of node `i` below its cut; exactly 0 or 1 where a side surely is empty.
double share_below(const GrownTree& grown, std::size_t i) {
  const auto& node = grown.nodes[i];
  const double f = node.cut * (1.0 / kTreeCuts), scale = grown.effective_rays / grown.total_weight;
  const double left = scale * grown.nodes[i + 1].weight, right = scale * grown.nodes[i + node.right].weight;
  const double all = left + right;
  if (left <= 0.0 && all * f > kSurelyEmpty) return 0.0;
  if (right <= 0.0 && all * (1.0 - f) > kSurelyEmpty) return 1.0;
  return (left + kPrior * f) / (all + kPrior);
}

std::int16_t coded_step(const TreeNode& node, double share_below, double rays) {
  const double f = node.cut * (1.0 / kTreeCuts);
  const double log_odds = std::log(share_below / (1.0 - share_below)) - std::log(f / (1.0 - f));
  const double steps = std::round(log_odds / step_width(f, rays));
  return static_cast<std::int16_t>(std::clamp<double>(steps, -kLargestStep, kLargestStep));
}

}  // namespace

double tree_share(const TreeNode& node, double rays) {
  if (node.step == kLeftEmpty) return 0.0;
  if (node.step == kRightEmpty) return 1.0;
  const double f = node.cut * (1.0 / kTreeCuts);
  const double e = exact_exp(std::clamp(node.step * step_width(f, rays), -60.0, 60.0));
  return f * e / (f * e + 1.0 - f);
}

std::size_t retained_splits(const GrownTree& grown, double penalty_nats) {
  return splits_retained_below(grown, penalty_nats)[0];
}

PrunedTree prune_exactly(const GrownTree& grown, double penalty_nats) {
  const auto splits = splits_retained_below(grown, penalty_nats);
  PrunedTree pruned;
  pruned.tree.rays = grown.effective_rays;
  pruned.tree.nodes.resize(2 * static_cast<std::size_t>(splits[0]) + 1);
  struct Pending {
    std::size_t from, to;
    double share;
  };
  std::vector<Pending> stack{{0, 0, 1.0}};
  while (!stack.empty()) {
    const Pending p = stack.back();
    stack.pop_back();
    if (splits[p.from] == 0) {
      pruned.leaf_shares.push_back(p.share);
      continue;
    }
    const auto& node = grown.nodes[p.from];
    TreeNode& retained = pruned.tree.nodes[p.to];
    retained.right = 2 + 2 * splits[p.from + 1];
    retained.axis = node.axis;
    retained.cut = node.cut;
    const double left = share_below(grown, p.from);
    if (left <= 0.0) retained.step = kLeftEmpty;
    if (left >= 1.0) retained.step = kRightEmpty;
    stack.push_back({p.from + node.right, p.to + retained.right, p.share * (1.0 - left)});
    stack.push_back({p.from + 1, p.to + 1, p.share * left});
  }
  return pruned;
}

DensityTree settled(PrunedTree pruned) {
  DensityTree tree = std::move(pruned.tree);
  std::vector<double> share(tree.nodes.size(), 0.0);
  std::size_t leaf = pruned.leaf_shares.size();
  for (std::size_t i = share.size(); i-- > 0;) {
    const TreeNode& n = tree.nodes[i];
    share[i] = n.is_leaf() ? pruned.leaf_shares[--leaf] : share[i + 1] + share[i + n.right];
  }
  std::vector<double> stored(tree.nodes.size(), 1.0);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    TreeNode& n = tree.nodes[i];
    if (n.is_leaf()) continue;
    const double rays = tree.rays * stored[i];
    if (n.step != kLeftEmpty && n.step != kRightEmpty)
      n.step = share[i] > 0.0 ? coded_step(n, share[i + 1] / share[i], rays) : std::int16_t{0};
    const double left = tree_share(n, rays);
    stored[i + 1] = stored[i] * left;
    stored[i + n.right] = stored[i] * (1.0 - left);
  }
  return tree;
}

DensityTree prune_tree(const GrownTree& grown, double penalty_nats) {
  return settled(prune_exactly(grown, penalty_nats));
}

}  // namespace lucerna
