// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/fitted_support.h"

#include <algorithm>

namespace lucerna {

namespace {

constexpr double kEvenShare = 0.01;

BoundedSupport about(const Vec3& focus_mm, const RayBlock& rays) {
  Support plain;
  plain.kind = SupportKind::focal;
  plain.world_from_support = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, focus_mm);
  return bounded(plain, rays);
}

}  // namespace

FittedSupport::FittedSupport(const RayBlock& rays, std::span<const float> weight, BoundedSupport on,
                             double tolerance_mm, int trees)
    : on_(std::move(on)) {
  Projection p = project(rays, weight, on_, tolerance_mm);
  const double total = p.weight + p.missed_weight;
  carried_ = total > 0.0 ? p.weight / total : 0.0;
  for (ChartItems& c : p.charts) {
    const double share = c.weight / total / on_.support.etendue_ratio() / trees;
    charts_.push_back({c.chart, share, {}});
    const GrowOptions grow{.penalty_nats = kQuickPenaltyNats};
    for (const GrownTree& grown : grow_trees(c.items, c.box, grow, static_cast<std::size_t>(trees))) {
      const DensityTree tree = prune_tree(grown, kQuickPenaltyNats);
      leaves_ += tree.leaves();
      charts_.back().trees.emplace_back(tree, c.box);
    }
    volume_ += c.box.volume() * on_.support.etendue_ratio();
  }
}

void FittedSupport::densities(const ChartBatch& lines, std::span<double> out) const {
  std::fill(out.begin(), out.end(), 0.0);
  for (const Chart& c : charts_) {
    std::array<std::array<double, 4>, kSupportBatch> points;
    std::array<std::size_t, kSupportBatch> which;
    std::array<double, kSupportBatch> sum{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      if (lines.chart[i] != c.chart) continue;
      points[n] = lines.point(i);
      which[n++] = i;
    }
    for (const TreeLookup& tree : c.trees)
      tree.add_densities(std::span(points).first(n), std::span(sum).first(n));
    for (std::size_t i = 0; i < n; ++i) out[which[i]] = c.share * sum[i];
  }
}

void FittedSupport::densities(const RayBlock& rays, std::size_t first, std::span<double> out) const {
  RayBatch batch;
  ChartBatch lines;
  for (std::size_t at = 0; at < out.size(); at += kSupportBatch) {
    const std::size_t n = std::min(kSupportBatch, out.size() - at);
    load_batch(rays, first + at, 1, n, batch);
    charts_of(on_.support, batch, lines);
    densities(lines, out.subspan(at, n));
  }
}

BackgroundDensity::BackgroundDensity(const RayBlock& rays, std::span<const float> weight,
                                     const Vec3& focus_mm, double tolerance_mm)
    : fitted_(rays, weight, about(focus_mm, rays), tolerance_mm) {
  even_ = kEvenShare / fitted_.volume();
}

void BackgroundDensity::densities(const RayBlock& rays, std::size_t first, std::span<double> out) const {
  fitted_.densities(rays, first, out);
  for (double& d : out) d = (1.0 - kEvenShare) * d + even_;
}

}  // namespace lucerna
