// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <numbers>

#include "lucerna/core/vec.h"

namespace lucerna {

/// A unit vector: only `Direction::from` makes one from three numbers, so its length is 1 to a few ulp.
class Direction {
 public:
  /// +z.
  constexpr Direction() = default;

  /// `v` scaled to unit length. `v` must be finite and not zero (the caller checks; a zero vector gives NaN).
  LUCERNA_HD static Direction from(const Vec3& v) { return Direction(v / length(v)); }

  /// `v` taken as it is: for vectors that are unit by construction, as after a rotation or reflection.
  LUCERNA_HD static constexpr Direction from_unit(const Vec3& v) { return Direction(v); }

  LUCERNA_HD constexpr double x() const { return v_.x; }
  LUCERNA_HD constexpr double y() const { return v_.y; }
  LUCERNA_HD constexpr double z() const { return v_.z; }
  LUCERNA_HD constexpr const Vec3& vec() const { return v_; }
  // NOLINTNEXTLINE(google-explicit-constructor): a direction is a vector wherever one is asked for
  LUCERNA_HD constexpr operator const Vec3&() const { return v_; }
  LUCERNA_HD friend constexpr Direction operator-(const Direction& d) { return Direction(-d.v_); }
  friend constexpr bool operator==(const Direction&, const Direction&) = default;

 private:
  LUCERNA_HD explicit constexpr Direction(const Vec3& v) : v_(v) {}
  Vec3 v_{0.0, 0.0, 1.0};
};

/// A half line: where it starts, where it goes.
struct Ray {
  Vec3 origin_mm;
  Direction direction;

  /// The point at distance `t_mm` along the ray.
  LUCERNA_HD Vec3 at(double t_mm) const { return origin_mm + t_mm * direction.vec(); }
};

/// Mirror image of `incident` about the plane with `normal` (either sign). Unit to a few ulp.
LUCERNA_HD inline Direction reflect(const Direction& incident, const Direction& normal) {
  return Direction::from_unit(incident.vec() - (2.0 * dot(incident, normal)) * normal.vec());
}

/// Angle between two directions in radians, [0, pi]; exact also for nearly equal or opposite ones
/// (Kahan's formula with atan2 instead of acos).
inline double angle_between(const Direction& a, const Direction& b) {
  return 2.0 * std::atan2(length(a.vec() - b.vec()), length(a.vec() + b.vec()));
}

LUCERNA_HD constexpr double radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }
LUCERNA_HD constexpr double degrees(double radians) { return radians * (180.0 / std::numbers::pi); }

/// CIE Type C angles of a direction in the luminaire frame of `design.md` section 4: nadir (gamma 0) = -z,
/// C 0 = +x, C 90 = +y. `c_rad` in [0, 2 pi), 0 on the axis; `gamma_rad` in [0, pi].
struct TypeCAngles {
  double c_rad = 0.0;
  double gamma_rad = 0.0;
};

LUCERNA_HD inline TypeCAngles type_c_angles(const Direction& d) {
  const double across = std::hypot(d.x(), d.y());
  double c = across > 0.0 ? std::atan2(d.y(), d.x()) : 0.0;
  if (c < 0.0) c += 2.0 * std::numbers::pi;
  if (c >= 2.0 * std::numbers::pi) c = 0.0;
  return {c, std::atan2(across, -d.z())};
}

/// The inverse of `type_c_angles`.
inline Direction direction_from_type_c(const TypeCAngles& a) {
  const double s = std::sin(a.gamma_rad);
  return Direction::from_unit({s * std::cos(a.c_rad), s * std::sin(a.c_rad), -std::cos(a.gamma_rad)});
}

}  // namespace lucerna
