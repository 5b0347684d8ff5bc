// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/source/adaptive/search/support_search.h"

namespace lucerna {

/// Scores supports by held-out likelihood: a tree is grown from two thirds of the rays, the rest say how
/// probable they are under it. So that supports that carry different rays can be compared, 2 % of a plain
/// density about the focus is mixed in, and all of the share that the support does not carry.
/// Immutable once made; thread safe.
class HeldOutScorer {
 public:
  /// `trees`: a mean of so many is grown for each score.
  HeldOutScorer(const RayBlock& rays, const Vec3& focus_mm, double tolerance_mm, int trees = 1);

  SupportScore score(const Support& support) const;
  /// True if `a` is better than `b` by more than chance would have it: the mean of the rays' differences is
  /// above 3 of its standard errors. Both must be scores of this scorer.
  bool clearly_better(const SupportScore& a, const SupportScore& b) const;
  /// The best of the score and those of its support made as small as most rays allow (support_tighten.h).
  SupportScore tightened(SupportScore start) const;
  /// All at once, on all threads.
  std::vector<SupportScore> scores(const std::vector<Support>& supports) const;

 private:
  RayBlock train_, held_;
  double tolerance_mm_;
  int trees_;
  std::vector<double> plain_;  // density of each held-out ray under the plain model
};

}  // namespace lucerna
