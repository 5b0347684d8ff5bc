// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "lucerna/geometry.h"

namespace lucerna {

/// A unit vector as MCPL 3 stores it: two numbers, and the sign of the component that has the largest
/// magnitude, which the energy carries. The two are the other components, but that z is stored as 1 / z,
/// which says by its magnitude above 1 that z is not the largest, and by its place which of x and y is not
/// stored.
struct McplDirection {
  double first = 0.0, second = 0.0;
  bool negative = false;
};

inline McplDirection pack_direction(const Vec3& k) {
  const double x = std::abs(k.x), y = std::abs(k.y), z = std::abs(k.z);
  if (z >= std::max(x, y)) return {k.x, k.y, std::signbit(k.z)};
  const double inverse = k.z == 0.0 ? std::numeric_limits<double>::infinity() : 1.0 / k.z;
  if (x >= y) return {inverse, k.y, std::signbit(k.x)};
  return {k.x, inverse, std::signbit(k.y)};
}

/// The largest component is 0 where the other two leave none to it: the vector is then not unit.
inline Vec3 unpack_direction(const McplDirection& packed) {
  const auto third = [&](double a, double b) {
    const double size = std::sqrt(std::max(0.0, 1.0 - (a * a + b * b)));
    return packed.negative ? -size : size;
  };
  const double a = packed.first, b = packed.second;
  if (std::abs(a) > 1.0) return {third(b, 1.0 / a), b, 1.0 / a};
  if (std::abs(b) > 1.0) return {a, third(a, 1.0 / b), 1.0 / b};
  return {a, b, third(a, b)};
}

}  // namespace lucerna
