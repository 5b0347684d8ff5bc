// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/support_score.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/parallel.h"

namespace lucerna {

namespace {

constexpr double kPlainShare = 0.02, kPenaltyNats = 6.0;

struct FittedChart {
  std::uint32_t chart;
  double share;
  TreeLookup tree;
};

std::vector<FittedChart> fitted(Projection& p) {
  std::vector<FittedChart> charts;
  for (ChartItems& c : p.charts) {
    const DensityTree tree =
        prune_tree(grow_tree(c.items, c.box, {.penalty_nats = kPenaltyNats}), kPenaltyNats);
    charts.push_back({c.chart, c.weight / (p.weight + p.missed_weight), TreeLookup(tree, c.box)});
  }
  return charts;
}

double density_of(const std::vector<FittedChart>& charts, const Support& support, const Ray& ray) {
  const auto p = support.to_chart(ray);
  if (!p) return 0.0;
  for (const FittedChart& c : charts) {
    if (c.chart == p->chart) return c.share * c.tree.density(p->c) / support.etendue_ratio();
  }
  return 0.0;
}

}  // namespace

SupportJudge::SupportJudge(const RayBlock& rays, const Vec3& focus_mm, double tolerance_mm)
    : tolerance_mm_(tolerance_mm) {
  for (std::size_t i = 0; i < rays.size(); ++i) (i % 3 == 2 ? held_ : train_).append(rays, i);
  Support plain;
  plain.kind = SupportKind::focal;
  plain.world_from_support = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, focus_mm);
  Projection p = project(train_, train_.weight, bounded(plain, train_), tolerance_mm_);
  double volume = 0.0;
  for (const ChartItems& c : p.charts) volume += c.box.volume();
  const auto charts = fitted(p);
  for (std::size_t i = 0; i < held_.size(); ++i) {
    plain_.push_back(0.99 * density_of(charts, plain, held_.ray(i)) + 0.01 / volume);
  }
}

SupportScore SupportJudge::score(const Support& support) const {
  SupportScore score;
  score.on = bounded(support, train_);
  Projection p = project(train_, train_.weight, score.on, tolerance_mm_);
  score.carried = p.weight / (p.weight + p.missed_weight);
  const auto charts = fitted(p);
  const double plain_share = kPlainShare + (1.0 - kPlainShare) * (1.0 - score.carried);
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const double w = static_cast<double>(held_.weight[i]);
    if (!(w > 0.0)) continue;
    const double d =
        (1.0 - kPlainShare) * density_of(charts, support, held_.ray(i)) + plain_share * plain_[i];
    const double log_d = std::log(d);
    score.log_density.push_back(static_cast<float>(log_d));
    sum += w * log_d;
    weight += w;
  }
  score.nats = weight > 0.0 ? sum / weight : -1e300;
  return score;
}

bool SupportJudge::clearly_better(const SupportScore& a, const SupportScore& b) const {
  constexpr double kClear = 1.5;
  double squares = 0.0, weight = 0.0;
  std::size_t k = 0;
  const double mean = a.nats - b.nats;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const double w = static_cast<double>(held_.weight[i]);
    if (!(w > 0.0)) continue;
    const double d = static_cast<double>(a.log_density[k]) - static_cast<double>(b.log_density[k]) - mean;
    ++k;
    squares += w * w * d * d, weight += w;
  }
  return weight > 0.0 && mean > kClear * std::sqrt(squares) / weight;
}

std::vector<SupportScore> SupportJudge::scores(const std::vector<Support>& supports) const {
  return parallel_map_blocks<SupportScore>(supports.size(), 1,
                                           [&](std::size_t i, std::size_t) { return score(supports[i]); });
}

}  // namespace lucerna
