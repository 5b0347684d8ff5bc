// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/photometry/binning/jackknife.h"

namespace lucerna {

/// Chooses the kernel for one figure. A wide kernel has little noise and smooths structure away; a narrow one
/// the reverse. Estimates are added from wide to narrow. The widest is taken from which no narrower one
/// differs by more than three errors of the difference (O. Lepski, 1990). Its error has its noise and its
/// bias: the largest distance to a narrower kernel's estimate beyond two errors of that distance, and the
/// bias of the narrowest itself. That is taken to be its distance to the next wider one, as it is where bias
/// falls in proportion to the radius and radii are halved.
class RadiusChoice {
 public:
  /// `standard_error` is that of `values`, or more where they were selected.
  void add(Jackknife values, double standard_error);
  /// Three estimates or more are there, and narrower ones would have more than thrice the noise of the best.
  bool complete() const;
  std::size_t size() const { return values_.size(); }

  struct Choice {
    /// In the order in which they were added.
    std::size_t index = 0;
    /// Scaled to `error`.
    Jackknife values;
    /// Of noise and bias, and of noise alone.
    double error = 0.0, noise = 0.0;
    Estimate estimate() const { return {values.all(), error}; }
  };
  /// The widest where errors are not known. At least one was added.
  Choice best() const;

 private:
  std::size_t widest_accepted() const;
  double bias(std::size_t i) const;
  /// By how much i and k differ beyond so many errors of their difference.
  double beyond_noise(std::size_t i, std::size_t k, double errors) const;

  std::vector<Jackknife> values_;
  std::vector<double> noise_;
};

}  // namespace lucerna
