// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/geometry.h"

namespace lucerna {

/// Directions between two angles of C and two of gamma; c1 may be beyond a whole turn. A single direction
/// where the bounds are equal.
struct DirectionCell {
  double c0_rad = 0.0, c1_rad = 0.0, gamma0_rad = 0.0, gamma1_rad = 0.0;

  double solid_angle_sr() const { return (c1_rad - c0_rad) * (std::cos(gamma0_rad) - std::cos(gamma1_rad)); }

  /// The angles of (u, v) in the unit square, evenly over the solid angle.
  TypeCAngles at(double u, double v) const {
    const double z0 = std::cos(gamma0_rad), z1 = std::cos(gamma1_rad);
    const double gamma =
        gamma0_rad == gamma1_rad ? gamma0_rad : std::acos(std::clamp(z0 + v * (z1 - z0), -1.0, 1.0));
    return {c0_rad + u * (c1_rad - c0_rad), gamma};
  }
  Direction centre() const {
    return direction_from_type_c({0.5 * (c0_rad + c1_rad), 0.5 * (gamma0_rad + gamma1_rad)});
  }
  /// No direction of the cell is further from `centre`.
  double radius_rad() const {
    const double half_c = std::min(0.5 * (c1_rad - c0_rad), std::numbers::pi);
    const double across = std::max(std::sin(gamma0_rad), std::sin(gamma1_rad));
    return 0.5 * (gamma1_rad - gamma0_rad) + half_c * across;
  }
};

}  // namespace lucerna
