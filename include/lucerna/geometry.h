// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lucerna/host_device.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Three doubles: a point or a displacement. Units are in the name of the variable (`origin_mm`).
struct Vec3 {
  /// Components.
  double x = 0.0, y = 0.0, z = 0.0;

  /// Adds component by component.
  LUCERNA_HD constexpr Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  /// Sum, component by component.
  LUCERNA_HD friend constexpr Vec3 operator+(const Vec3& a, const Vec3& b) {
    return {a.x + b.x, a.y + b.y, a.z + b.z};
  }
  /// Difference, component by component.
  LUCERNA_HD friend constexpr Vec3 operator-(const Vec3& a, const Vec3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
  }
  /// The opposite vector.
  LUCERNA_HD friend constexpr Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
  /// Every component times `s`.
  LUCERNA_HD friend constexpr Vec3 operator*(double s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  /// Every component times `s`.
  LUCERNA_HD friend constexpr Vec3 operator*(const Vec3& a, double s) { return s * a; }
  /// Every component over `s`.
  LUCERNA_HD friend constexpr Vec3 operator/(const Vec3& a, double s) { return {a.x / s, a.y / s, a.z / s}; }
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

/// Scalar product.
LUCERNA_HD constexpr double dot(const Vec3& a, const Vec3& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }

/// Vector product, right-handed.
LUCERNA_HD constexpr Vec3 cross(const Vec3& a, const Vec3& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// Euclidean length.
LUCERNA_HD inline double length(const Vec3& a) { return std::sqrt(dot(a, a)); }

/// True if no component is infinite or not a number.
LUCERNA_HD inline bool is_finite(const Vec3& a) {
  return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// A unit vector: only `Direction::from` makes one from three numbers, so its length is 1 to a few ulp.
class Direction {
 public:
  /// +z.
  constexpr Direction() = default;

  /// `v` scaled to unit length. `v` must be finite and not zero (the caller checks; a zero vector gives NaN).
  LUCERNA_HD static Direction from(const Vec3& v) { return Direction(v / length(v)); }

  /// `v` taken as it is: for vectors that are unit by construction, as after a rotation or reflection.
  LUCERNA_HD static constexpr Direction from_unit(const Vec3& v) { return Direction(v); }

  /// Component along x, in [-1, 1].
  LUCERNA_HD constexpr double x() const { return v_.x; }
  /// Component along y, in [-1, 1].
  LUCERNA_HD constexpr double y() const { return v_.y; }
  /// Component along z, in [-1, 1].
  LUCERNA_HD constexpr double z() const { return v_.z; }
  /// The same as a vector.
  LUCERNA_HD constexpr const Vec3& vec() const { return v_; }
  /// A direction is a vector wherever one is expected.
  // NOLINTNEXTLINE(google-explicit-constructor): a direction is a vector wherever one is asked for
  LUCERNA_HD constexpr operator const Vec3&() const { return v_; }
  /// The opposite direction.
  LUCERNA_HD friend constexpr Direction operator-(const Direction& d) { return Direction(-d.v_); }
  friend constexpr bool operator==(const Direction&, const Direction&) = default;

 private:
  LUCERNA_HD explicit constexpr Direction(const Vec3& v) : v_(v) {}
  Vec3 v_{0.0, 0.0, 1.0};
};

/// A half line: where it starts, where it goes.
struct Ray {
  Vec3 origin_mm;       ///< where it starts
  Direction direction;  ///< where it goes

  /// The point at distance `t_mm` along the ray.
  LUCERNA_HD Vec3 at(double t_mm) const { return origin_mm + t_mm * direction.vec(); }
};

/// Mirror image of `incident` about the plane with `normal` (either sign). Unit to a few ulp.
[[nodiscard]] LUCERNA_HD inline Direction reflect(const Direction& incident, const Direction& normal) {
  return Direction::from_unit(incident.vec() - (2.0 * dot(incident, normal)) * normal.vec());
}

/// Angle between two directions in radians, [0, pi]; exact also for nearly equal or opposite ones
/// (Kahan's formula with atan2 instead of acos).
inline double angle_between(const Direction& a, const Direction& b) {
  return 2.0 * std::atan2(length(a.vec() - b.vec()), length(a.vec() + b.vec()));
}

/// Degrees to radians.
LUCERNA_HD constexpr double radians(double degrees) { return degrees * (std::numbers::pi / 180.0); }
/// Radians to degrees.
LUCERNA_HD constexpr double degrees(double radians) { return radians * (180.0 / std::numbers::pi); }

/// CIE Type C angles of a direction in the luminaire frame of docs/concepts/frames-and-units.md: nadir (gamma
/// 0) = -z, C 0 = +x, C 90 = +y. `c_rad` in [0, 2 pi), 0 on the axis; `gamma_rad` in [0, pi].
struct TypeCAngles {
  /// [0, 2 pi).
  double c_rad = 0.0;
  /// [0, pi].
  double gamma_rad = 0.0;
};

/// The angles of a direction.
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

/// A right-handed orthonormal frame placed in an outer ("world") frame: a rotation, then a translation.
/// Named like a fraction where it is used: `world_from_lamp.point(p_lamp)`; `world_from_lamp *
/// lamp_from_chip`.
class Frame {
 public:
  /// The identity.
  constexpr Frame() = default;

  /// Columns `ex`, `ey`, `ez` are the images of the inner axes; they must be orthonormal and right-handed.
  LUCERNA_HD constexpr Frame(const Vec3& ex, const Vec3& ey, const Vec3& ez, const Vec3& origin_mm)
      : ex_(ex), ey_(ey), ez_(ez), origin_mm_(origin_mm) {}

  /// The placement of the project file: the inner +z goes to `axis` by the shortest turn (for -z a half turn
  /// about +x), then everything turns about that axis by `turn_rad`, then moves to `position_mm`.
  [[nodiscard]] static Frame from_axis(const Direction& axis, double turn_rad, const Vec3& position_mm);

  /// Right-hand rotation by `angle_rad` about `axis` through the origin.
  [[nodiscard]] static Frame rotation(const Direction& axis, double angle_rad);

  /// Any frame whose +z is `z`, without discontinuity but at z = -e_z (Duff et al. 2017, JCGT 6(1)).
  [[nodiscard]] LUCERNA_HD static Frame from_z(const Direction& z, const Vec3& origin_mm = {}) {
    const double sign = std::copysign(1.0, z.z());
    const double a = -1.0 / (sign + z.z());
    const double b = z.x() * z.y() * a;
    return {{1.0 + sign * z.x() * z.x() * a, sign * b, -sign * z.x()},
            {b, sign + z.y() * z.y() * a, -z.y()},
            z.vec(),
            origin_mm};
  }

  /// A displacement of the inner frame in the outer frame: rotated only.
  LUCERNA_HD Vec3 vector(const Vec3& v) const { return v.x * ex_ + v.y * ey_ + v.z * ez_; }
  /// A point of the inner frame in the outer frame: rotated, then translated.
  LUCERNA_HD Vec3 point(const Vec3& p_mm) const { return vector(p_mm) + origin_mm_; }
  /// A direction of the inner frame in the outer frame.
  LUCERNA_HD Direction direction(const Direction& d) const { return Direction::from_unit(vector(d)); }
  /// A ray of the inner frame in the outer frame.
  LUCERNA_HD Ray ray(const Ray& r) const { return {point(r.origin_mm), direction(r.direction)}; }

  /// The way back.
  [[nodiscard]] LUCERNA_HD Frame inverse() const {
    const Frame transposed{{ex_.x, ey_.x, ez_.x}, {ex_.y, ey_.y, ez_.y}, {ex_.z, ey_.z, ez_.z}, {}};
    return {transposed.ex_, transposed.ey_, transposed.ez_, -transposed.vector(origin_mm_)};
  }

  /// Image of the inner x axis; unit.
  LUCERNA_HD const Vec3& ex() const { return ex_; }
  /// Image of the inner y axis; unit.
  LUCERNA_HD const Vec3& ey() const { return ey_; }
  /// Image of the inner z axis; unit.
  LUCERNA_HD const Vec3& ez() const { return ez_; }
  /// Image of the inner origin.
  LUCERNA_HD const Vec3& origin_mm() const { return origin_mm_; }

  /// Composition: `b` first, then `a`.
  friend Frame operator*(const Frame& a, const Frame& b) {
    return {a.vector(b.ex_), a.vector(b.ey_), a.vector(b.ez_), a.point(b.origin_mm_)};
  }
  friend bool operator==(const Frame&, const Frame&) = default;

 private:
  Vec3 ex_{1.0, 0.0, 0.0}, ey_{0.0, 1.0, 0.0}, ez_{0.0, 0.0, 1.0}, origin_mm_{};
};

}  // namespace lucerna
#pragma GCC visibility pop
