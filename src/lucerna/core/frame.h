// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "lucerna/core/direction.h"

namespace lucerna {

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
  static Frame from_axis(const Direction& axis, double turn_rad, const Vec3& position_mm);

  /// Right-hand rotation by `angle_rad` about `axis` through the origin.
  static Frame rotation(const Direction& axis, double angle_rad);

  /// Any frame whose +z is `z`, without discontinuity but at z = -e_z (Duff et al. 2017, JCGT 6(1)).
  LUCERNA_HD static Frame from_z(const Direction& z, const Vec3& origin_mm = {}) {
    const double sign = std::copysign(1.0, z.z());
    const double a = -1.0 / (sign + z.z());
    const double b = z.x() * z.y() * a;
    return {{1.0 + sign * z.x() * z.x() * a, sign * b, -sign * z.x()},
            {b, sign + z.y() * z.y() * a, -z.y()},
            z.vec(),
            origin_mm};
  }

  LUCERNA_HD Vec3 vector(const Vec3& v) const { return v.x * ex_ + v.y * ey_ + v.z * ez_; }
  LUCERNA_HD Vec3 point(const Vec3& p_mm) const { return vector(p_mm) + origin_mm_; }
  LUCERNA_HD Direction direction(const Direction& d) const { return Direction::from_unit(vector(d)); }
  LUCERNA_HD Ray ray(const Ray& r) const { return {point(r.origin_mm), direction(r.direction)}; }

  /// The way back.
  LUCERNA_HD Frame inverse() const {
    const Frame transposed{{ex_.x, ey_.x, ez_.x}, {ex_.y, ey_.y, ez_.y}, {ex_.z, ey_.z, ez_.z}, {}};
    return {transposed.ex_, transposed.ey_, transposed.ez_, -transposed.vector(origin_mm_)};
  }

  LUCERNA_HD const Vec3& ex() const { return ex_; }
  LUCERNA_HD const Vec3& ey() const { return ey_; }
  LUCERNA_HD const Vec3& ez() const { return ez_; }
  LUCERNA_HD const Vec3& origin_mm() const { return origin_mm_; }

  friend Frame operator*(const Frame& a, const Frame& b) {
    return {a.vector(b.ex_), a.vector(b.ey_), a.vector(b.ez_), a.point(b.origin_mm_)};
  }
  friend bool operator==(const Frame&, const Frame&) = default;

 private:
  Vec3 ex_{1.0, 0.0, 0.0}, ey_{0.0, 1.0, 0.0}, ez_{0.0, 0.0, 1.0}, origin_mm_{};
};

}  // namespace lucerna
