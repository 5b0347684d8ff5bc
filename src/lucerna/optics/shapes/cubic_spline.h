// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace lucerna {

/// What a cubic spline does at an end: its third derivative has no jump at the knot next to the end; slope 0;
/// second derivative 0.
enum class SplineEnd { not_a_knot, flat, natural };

/// Slopes at the knots of the C2 cubic spline (C. de Boor, "A Practical Guide to Splines", ch. IV). `h`:
/// lengths of the intervals, > 0; `delta`: their secant slopes; at least two intervals. O(intervals).
std::vector<double> spline_slopes(const std::vector<double>& h, const std::vector<double>& delta,
                                  SplineEnd start, SplineEnd end);

}  // namespace lucerna
