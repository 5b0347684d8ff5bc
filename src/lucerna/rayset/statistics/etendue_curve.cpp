// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/statistics/etendue_curve.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <span>

#include "lucerna/geometry.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/data/halves.h"

namespace lucerna {

namespace {

constexpr std::size_t kMaxCurveRays = 1 << 20, kBins = 32, kMin = 8;
/// Log-likelihood that a cut must gain: with 4 x 31 cuts to choose from, about one in 20 would by chance in
/// even light.
constexpr double kGain = 8.0;
constexpr double kGrazing = 0.01;
constexpr int kDeepest = 60;

struct Point {
  std::array<double, 4> at;  // mm, mm, direction cosines
  double weight;
};

/// A cell of the tree; a leaf where `axis` is negative.
struct Node {
  std::array<double, 4> low, high;
  int axis = -1;
  double cut = 0.0;
  std::size_t below = 0, above = 0;
  double trained = 0.0, tested = 0.0;
  double volume() const {
    double v = 1.0;
    for (std::size_t d = 0; d < 4; ++d) v *= high[d] - low[d];
    return v;
  }
};

struct Cut {
  int axis = -1;
  double at = 0.0, gain = kGain;
};

double log_density_sum(double n, double share_of_volume) {
  return n > 0.0 ? n * std::log(n / share_of_volume) : 0.0;
}

/// The cut among kBins - 1 per axis that explains the points best; `scale` turns weights into effective
/// counts.
Cut best_cut(const Node& node, std::span<const Point> points, double scale) {
  Cut best;
  for (std::size_t d = 0; d < 4; ++d) {
    std::array<double, kBins> bins{};
    const double width = (node.high[d] - node.low[d]) / kBins;
    if (!(width > 1e-9 * (1.0 + std::abs(node.low[d])))) continue;
    double total = 0.0;
    for (const Point& p : points) {
      const auto bin =
          static_cast<std::size_t>(std::clamp((p.at[d] - node.low[d]) / width, 0.0, kBins - 1.0));
      bins[bin] += p.weight * scale;
      total += p.weight * scale;
    }
    double below = 0.0;
    for (std::size_t k = 1; k < kBins; ++k) {
      below += bins[k - 1];
      const double share = static_cast<double>(k) / kBins;
      const double gain = log_density_sum(below, share) + log_density_sum(total - below, 1.0 - share) -
                          log_density_sum(total, 1.0);
      if (gain > best.gain) best = {static_cast<int>(d), node.low[d] + static_cast<double>(k) * width, gain};
    }
  }
  return best;
}

/// Even-numbered points grow the tree, odd-numbered ones measure its cells.
class Tree {
 public:
  Tree(std::vector<Point> train, const std::vector<Point>& test) : points_(std::move(train)) {
    double w = 0.0, w2 = 0.0;
    for (const Point& p : points_) w += p.weight, w2 += p.weight * p.weight;
    scale_ = w / w2;
    Node root;
    root.low.fill(std::numeric_limits<double>::infinity());
    root.high.fill(-std::numeric_limits<double>::infinity());
    for (const auto* half : std::array<const std::vector<Point>*, 2>{&points_, &test}) {
      for (const Point& p : *half) {
        for (std::size_t d = 0; d < 4; ++d)
          root.low[d] = std::min(root.low[d], p.at[d]), root.high[d] = std::max(root.high[d], p.at[d]);
      }
    }
    nodes_.push_back(root);
    grow(0, points_, 0);
    for (const Point& p : test) nodes_[leaf_of(p)].tested += p.weight;
  }

  void collect(std::vector<Node>& leaves) const {
    for (const Node& node : nodes_) {
      if (node.axis < 0) leaves.push_back(node);
    }
  }

 private:
  void grow(std::size_t index, std::span<Point> points, int depth) {
    for (const Point& p : points) nodes_[index].trained += p.weight;
    if (points.size() < kMin || depth == kDeepest) return;
    const Cut cut = best_cut(nodes_[index], points, scale_);
    if (cut.axis < 0) return;
    const auto d = static_cast<std::size_t>(cut.axis);
    const auto middle =
        std::partition(points.begin(), points.end(), [&](const Point& p) { return p.at[d] < cut.at; });
    Node below = nodes_[index], above = nodes_[index];
    below.high[d] = above.low[d] = cut.at;
    below.trained = above.trained = 0.0;
    nodes_[index].axis = cut.axis;
    nodes_[index].cut = cut.at;
    nodes_[index].below = nodes_.size();
    nodes_[index].above = nodes_.size() + 1;
    const std::size_t first = nodes_.size();
    nodes_.push_back(below);
    nodes_.push_back(above);
    const auto n = static_cast<std::size_t>(middle - points.begin());
    grow(first, points.first(n), depth + 1);
    grow(first + 1, points.subspan(n), depth + 1);
  }

  std::size_t leaf_of(const Point& p) const {
    std::size_t i = 0;
    while (nodes_[i].axis >= 0) {
      i = p.at[static_cast<std::size_t>(nodes_[i].axis)] < nodes_[i].cut ? nodes_[i].below : nodes_[i].above;
    }
    return i;
  }

  std::vector<Point> points_;
  std::vector<Node> nodes_;
  double scale_ = 1.0;
};

/// Rays as points of phase space on the focus plane: [side of the plane][half].
std::array<std::array<std::vector<Point>, 2>, 2> phase_space(const RayBlock& rays,
                                                             const RaySummary& summary) {
  std::array<std::array<std::vector<Point>, 2>, 2> points;
  const Vec3 mean = *summary.mean_direction;
  const Direction axis = length(mean) < 0.2 ? Direction() : Direction::from(mean);
  const Frame plane_from_world = Frame::from_z(axis, summary.virtual_focus->point_mm).inverse();
  const std::size_t n = std::min(kMaxCurveRays, rays.size());
  for (std::size_t j = 0; j < n; ++j) {
    const std::size_t i = rays.size() * j / n;
    const Ray ray = plane_from_world.ray(rays.ray(i));
    const double w = rays.weight[i], k = ray.direction.z();
    if (!(w > 0.0) || std::abs(k) < kGrazing) continue;
    const Vec3 p = ray.at(-ray.origin_mm.z / k);
    points[k < 0.0][in_second_half(1, j)].push_back({{p.x, p.y, ray.direction.x(), ray.direction.y()}, w});
  }
  return points;
}

}  // namespace

EtendueCurve etendue_curve(const RayBlock& rays) {
  const RaySummary summary = summarize(rays);
  if (!summary.virtual_focus) return {};
  auto points = phase_space(rays, summary);
  std::vector<Node> leaves;
  for (auto& [train, test] : points) {
    if (!train.empty()) Tree(std::move(train), test).collect(leaves);
  }
  std::erase_if(leaves, [](const Node& leaf) { return !(leaf.volume() > 1e-12) || !(leaf.trained > 0.0); });
  std::ranges::sort(leaves, std::greater<>{}, [](const Node& leaf) { return leaf.trained / leaf.volume(); });
  double total = 0.0;
  for (const Node& leaf : leaves) total += leaf.tested;
  if (!(total > 0.0)) return {};
  std::vector<EtendueCurve::Point> curve{{0.0, 0.0}};
  for (const Node& leaf : leaves) {
    curve.push_back({curve.back().flux + leaf.tested / total, curve.back().etendue + leaf.volume()});
  }
  return EtendueCurve(std::move(curve));
}

double EtendueCurve::at(double share) const {
  if (degenerate()) return 0.0;
  const auto above = std::ranges::lower_bound(points_, share, {}, &Point::flux);
  if (above == points_.begin()) return 0.0;
  if (above == points_.end()) return points_.back().etendue;
  const Point &a = *(above - 1), &b = *above;
  return b.flux > a.flux ? a.etendue + (share - a.flux) / (b.flux - a.flux) * (b.etendue - a.etendue)
                         : b.etendue;
}

}  // namespace lucerna
