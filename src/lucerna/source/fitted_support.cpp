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
                             double tolerance_mm)
    : on_(std::move(on)) {
  Projection p = project(rays, weight, on_, tolerance_mm);
  const double total = p.weight + p.missed_weight;
  carried_ = total > 0.0 ? p.weight / total : 0.0;
  for (ChartItems& c : p.charts) {
    const DensityTree tree =
        prune_tree(grow_tree(c.items, c.box, {.penalty_nats = kQuickPenaltyNats}), kQuickPenaltyNats);
    leaves_ += tree.leaves();
    volume_ += c.box.volume() * on_.support.etendue_ratio();
    charts_.push_back({c.chart, c.weight / total / on_.support.etendue_ratio(), TreeLookup(tree, c.box)});
  }
}

double FittedSupport::density(const Ray& ray) const {
  const auto p = on_.support.to_chart(ray);
  if (!p) return 0.0;
  for (const Chart& c : charts_) {
    if (c.chart == p->chart) return c.share * c.tree.density(p->c);
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
