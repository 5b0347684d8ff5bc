// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/fitted_support.h"

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
    for (int t = 0; t < trees; ++t) {
      const GrowOptions grow{.penalty_nats = kQuickPenaltyNats, .tree_number = static_cast<std::uint64_t>(t)};
      const DensityTree tree = prune_tree(grow_tree(c.items, c.box, grow), kQuickPenaltyNats);
      leaves_ += tree.leaves();
      charts_.back().trees.emplace_back(tree, c.box);
    }
    volume_ += c.box.volume() * on_.support.etendue_ratio();
  }
}

double FittedSupport::density(const Ray& ray) const {
  const auto p = on_.support.to_chart(ray);
  if (!p) return 0.0;
  for (const Chart& c : charts_) {
    if (c.chart != p->chart) continue;
    double sum = 0.0;
    for (const TreeLookup& tree : c.trees) sum += tree.density(p->c);
    return c.share * sum;
  }
  return 0.0;
}

PlainDensity::PlainDensity(const RayBlock& rays, std::span<const float> weight, const Vec3& focus_mm,
                           double tolerance_mm)
    : fitted_(rays, weight, about(focus_mm, rays), tolerance_mm) {
  even_ = kEvenShare / fitted_.volume();
}

double PlainDensity::density(const Ray& ray) const {
  return (1.0 - kEvenShare) * fitted_.density(ray) + even_;
}

}  // namespace lucerna
