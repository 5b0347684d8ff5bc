// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_score.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/adaptive/search/fitted_support.h"
#include "lucerna/source/adaptive/search/support_tighten.h"

namespace lucerna {

namespace {

constexpr double kBackgroundShare = 0.02;
/// Shares of rays that a tight support may miss: stray ones, and those of its blurred edge.
constexpr std::array<double, 4> kMissedShares{0.0, 1e-4, 1e-3, 5e-3};

}  // namespace

HeldOutScorer::HeldOutScorer(const RayBlock& rays, const Vec3& focus_mm, double tolerance_mm, int trees)
    : tolerance_mm_(tolerance_mm), trees_(trees) {
  for (std::size_t i = 0; i < rays.size(); ++i) (i % 3 == 2 ? held_ : train_).append(rays, i);
  const BackgroundDensity plain(train_, train_.weight, focus_mm, tolerance_mm_);
  plain_.resize(held_.size());
  plain.densities(held_, 0, plain_);
}

SupportScore HeldOutScorer::score(const Support& support) const {
  SupportScore score;
  score.on = bounded(support, train_);
  const FittedSupport fitted(train_, train_.weight, score.on, tolerance_mm_, trees_);
  score.carried = fitted.carried();
  const double background_share = kBackgroundShare + (1.0 - kBackgroundShare) * (1.0 - score.carried);
  std::vector<double> density(held_.size());
  fitted.densities(held_, 0, density);
  double sum = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < held_.size(); ++i) {
    const double w = static_cast<double>(held_.weight[i]);
    if (!(w > 0.0)) continue;
    const double d = (1.0 - kBackgroundShare) * density[i] + background_share * plain_[i];
    const double log_d = std::log(d);
    score.log_density.push_back(static_cast<float>(log_d));
    sum += w * log_d;
    weight += w;
  }
  score.nats = weight > 0.0 ? sum / weight : -1e300;
  return score;
}

bool HeldOutScorer::clearly_better(const SupportScore& a, const SupportScore& b) const {
  constexpr double kClear = 3.0;
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

SupportScore HeldOutScorer::tightened(SupportScore start) const {
  std::vector<Support> trials;
  for (const double missed : kMissedShares) {
    if (const auto t = lucerna::tightened(start.on.support, train_, missed)) trials.push_back(*t);
  }
  for (SupportScore& score : scores(trials)) {
    if (score.nats > start.nats) start = std::move(score);
  }
  return start;
}

std::vector<SupportScore> HeldOutScorer::scores(const std::vector<Support>& supports) const {
  return parallel_map_blocks<SupportScore>(supports.size(), 1,
                                           [&](std::size_t i, std::size_t) { return score(supports[i]); });
}

}  // namespace lucerna
