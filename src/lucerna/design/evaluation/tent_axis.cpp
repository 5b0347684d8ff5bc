// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/tent_axis.h"

#include <algorithm>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Narrowest reach of all cells beyond an edge, in cells of the window: a tent needs some width.
constexpr double kMinReach = 0.1;

TentAxis::Beyond beyond(double reach, double cell, int outer) {
  if (outer == 0) return {};
  const double room = std::max(reach, kMinReach * cell), equal = room / outer;
  if (equal <= cell) return {equal, 0.0};
  return {cell, (equal - cell) / outer};
}

}  // namespace

TentAxis tent_axis(double low, double high, int inner, int outer, double far_low, double far_high) {
  LUCERNA_CHECK(inner >= 2 && outer >= 0 && high > low, "{} cells over [{}, {}]", inner, low, high);
  TentAxis axis;
  axis.low = low;
  axis.cell = (high - low) / inner;
  axis.inner = inner;
  axis.outer = outer;
  axis.below = beyond(low - far_low, axis.cell, outer);
  axis.above = beyond(far_high - high, axis.cell, outer);
  return axis;
}

}  // namespace lucerna
