// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lucerna/host_device.h"

namespace lucerna {

/// Values of the four uniform cubic B-splines that are not zero at one place, or one of their derivatives.
using CubicBasis = std::array<double, 4>;

/// B-spline values at `t` in [0, 1] of a knot interval (C. de Boor, "A Practical Guide to Splines", ch. IX);
/// they sum to 1. Outside [0, 1] the interval's polynomials continue.
LUCERNA_HD inline CubicBasis cubic_basis(double t) {
  const double u = 1.0 - t, t2 = t * t, u2 = u * u;
  return {u2 * u / 6.0, 2.0 / 3.0 - 0.5 * t2 * (2.0 - t), 2.0 / 3.0 - 0.5 * u2 * (2.0 - u), t2 * t / 6.0};
}

/// Derivatives with respect to t; they sum to 0.
LUCERNA_HD inline CubicBasis cubic_basis_slope(double t) {
  const double u = 1.0 - t;
  return {-0.5 * u * u, t * (1.5 * t - 2.0), u * (2.0 - 1.5 * u), 0.5 * t * t};
}

/// Second derivatives with respect to t.
LUCERNA_HD inline CubicBasis cubic_basis_second(double t) {
  return {1.0 - t, 3.0 * t - 2.0, 1.0 - 3.0 * t, t};
}

/// A row of equal knot intervals: where a place lies in it. Places beyond the ends belong to the end
/// intervals.
struct KnotRow {
  double start_mm = 0.0, step_mm = 1.0;
  int intervals = 1;

  /// Coefficients of a cubic spline on it.
  LUCERNA_HD int coefficients() const { return intervals + 3; }
  double end_mm() const { return start_mm + step_mm * intervals; }

  struct Place {
    int first;  ///< first of the four coefficients that count here
    double t;
  };
  LUCERNA_HD Place place(double x_mm) const {
    const double u = (x_mm - start_mm) / step_mm;
    int i = static_cast<int>(u);
    i = i < 0 ? 0 : (i >= intervals ? intervals - 1 : i);
    return {i, u - i};
  }
  friend bool operator==(const KnotRow&, const KnotRow&) = default;
};

}  // namespace lucerna
