// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

namespace lucerna {

/// Cuts [t0, t1] of a line with coordinate o + t d to where that is from `low` to `high`; t1 is below t0
/// where it is nowhere.
inline void clip_line(double o, double d, double low, double high, double& t0, double& t1) {
  if (d == 0.0) {
    if (o < low || o > high) t1 = -1.0;
    return;
  }
  const double a = (low - o) / d, b = (high - o) / d;
  t0 = std::max(t0, std::min(a, b));
  t1 = std::min(t1, std::max(a, b));
}

}  // namespace lucerna
