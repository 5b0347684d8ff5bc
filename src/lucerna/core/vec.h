// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lucerna/core/host_device.h"

namespace lucerna {

/// Three doubles: a point or a displacement. Units are in the name of the variable (`origin_mm`).
struct Vec3 {
  double x = 0.0, y = 0.0, z = 0.0;

  LUCERNA_HD constexpr Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  LUCERNA_HD friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  LUCERNA_HD friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  LUCERNA_HD friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  LUCERNA_HD friend constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  LUCERNA_HD friend constexpr Vec3 operator*(const Vec3& a, double s) { return s * a; }
  LUCERNA_HD friend constexpr Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

LUCERNA_HD constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

LUCERNA_HD constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

LUCERNA_HD inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// True if no component is infinite or not a number.
LUCERNA_HD inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

}  // namespace lucerna
