// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "lucerna/trace/trace_result.h"

namespace lucerna {

/// Figures over all cells of a plane or luminance image. What choosing among noisy cells adds to the greatest
/// and takes off the least is corrected (jackknife.h, `largest`); of more than 2048 cells within six errors
/// of the extreme the 2048 best are looked at.
struct PlaneExtremes {
  Estimate mean, least, greatest;
  /// least over mean; absent for a dark plane.
  std::optional<Estimate> uniformity;
  /// Where the greatest is.
  std::size_t greatest_cell = 0;
};

/// Of `illuminance(result, index)`. O(cells).
PlaneExtremes illuminance_extremes(const TraceResult& result, std::size_t index, const PlaneImage& image);
/// Of `luminance(result, index)`.
PlaneExtremes luminance_extremes(const TraceResult& result, std::size_t index, const PlaneImage& image);

}  // namespace lucerna
