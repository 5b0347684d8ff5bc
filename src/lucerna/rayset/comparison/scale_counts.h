// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lucerna/ray_comparison.h"

namespace lucerna {

/// Weights in cells of the focus plane's window, fine enough for the smallest scale of compare_scales. One
/// thread at a time.
class ScaleCounts {
 public:
  /// Cells along each edge of the window at the smallest scale; each scale has half as many as the one
  /// before.
  static constexpr std::size_t kSide = 128;

  /// Empty counts for `views`, which must outlive them.
  explicit ScaleCounts(const Views& views);

  /// Adds rays, on all threads; the same bits for any number of them. About 10 ns a ray and thread.
  void add(const RayBlock& rays);

  double total_weight() const { return total_weight_; }
  const ViewWindow& window() const { return window_; }
  /// Of the kSide x kSide cells; what lies outside of them counts in the total alone.
  const std::vector<double>& weights() const { return weights_; }
  const std::vector<double>& squares() const { return squares_; }

 private:
  const Views* views_;
  ViewWindow window_;
  double total_weight_ = 0.0;
  std::vector<double> weights_, squares_;
};

/// Illuminance on the focus plane at five scales, the smallest cells first. Throws InputError when reference
/// or test has no flux.
std::array<ScaleDifference, 5> compare_scales(const ScaleCounts& reference, const ScaleCounts& test,
                                              const ScaleCounts& training);

}  // namespace lucerna
