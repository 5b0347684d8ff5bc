// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lucerna/rayset/view.h"

namespace lucerna {

/// Weights that fell in the cells of the five views, of as many rays as were added. One thread at a time.
class ViewCounts {
 public:
  /// Empty counts for `views`, which must outlive them.
  explicit ViewCounts(const Views& views);

  /// Adds rays, on all threads; the same bits for any number of them. About 0.4 us a ray and thread. Rays
  /// that a view does not see count in the total that shares refer to, and in no cell.
  void add(const RayBlock& rays);

  const Views& views() const { return *views_; }
  double total_weight() const { return total_weight_; }
  /// Sum of weights, and of squared weights, per cell.
  const std::vector<double>& weights(ViewKind kind) const { return weights_[static_cast<std::size_t>(kind)]; }
  const std::vector<double>& squares(ViewKind kind) const { return squares_[static_cast<std::size_t>(kind)]; }

 private:
  const Views* views_;
  double total_weight_ = 0.0;
  std::array<std::vector<double>, 5> weights_, squares_;
};

/// How far a test is from its reference in one view; all relative to the l2 norm of the reference's shares.
struct ViewDifference {
  /// |p - q| / |p| with shares p of the reference and q of the test; what is seen, noise included.
  double error = 0.0;
  /// The counting noise of both sets: root of their summed squared weights.
  double floor = 0.0;
  /// sqrt(max(0, error^2 - floor^2)): the test's own error.
  double excess = 0.0;
  /// Standard error of `excess`: floor * (2 / cells)^(1/4) where the excess is small, with the number of
  /// cells that carry the noise; falls as 1 / excess where it is large.
  double standard_error = 0.0;
  /// The noise that the training rays have in this view: excess below raw means a model better than its rays.
  double raw = 0.0;
};

struct RaySetComparison {
  ViewDifference far, near, focus, beam, four_d;
  /// far, near, focus, beam or four_d.
  const ViewDifference& operator[](ViewKind kind) const;
  ViewDifference& operator[](ViewKind kind);
};

/// Compares what was counted in one set of views. `training` (the rays that a model was made from) gives
/// `raw`; without it the reference is taken to be what the test was made from. Throws InputError when
/// reference or test has no flux.
RaySetComparison compare_view_counts(const ViewCounts& reference, const ViewCounts& test,
                                     const ViewCounts* training = nullptr);

/// The whole of it for rays in memory: views from `reference`, then all counts. Symmetric in nothing but the
/// noise.
RaySetComparison compare_ray_sets(const RayBlock& reference, const RayBlock& test,
                                  const RayBlock* training = nullptr);

}  // namespace lucerna
