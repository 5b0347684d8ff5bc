// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"

namespace lucerna {

/// A ball of clear material about a source, such as an LED's dome: what leaves it is the image of what shines
/// inside. A line outside has one line inside that refracts into it (Snell's law at the point where it
/// leaves) and n^2 dG_inside = dG_outside, so a density inside is one outside, divided by n^2. Reflections at
/// the surface are not followed. Immutable, thread safe.
struct RefractingSphere {
  /// In the world, mm. Radius 0: there is no ball, lines stay as they are.
  Vec3 centre_mm;
  double radius_mm = 0.0;
  double index = 1.0;

  /// Share of the largest offset at which light still leaves: at the whole of it, it runs along the surface.
  static constexpr double kLeaves = 1.0 - 1e-9;

  LUCERNA_HD bool exists() const { return radius_mm > 0.0; }
  /// dG outside over dG inside.
  double etendue_ratio() const { return exists() ? index * index : 1.0; }

  /// The ray inside, from the point where it leaves the ball; nothing for lines that miss the ball.
  std::optional<Ray> inside(const Ray& outside) const;
  /// The ray outside, from the point where it leaves the ball. Lines that would be reflected back inside are
  /// first moved towards the centre until they leave along the surface (leaves of a model reach a little too
  /// far).
  LUCERNA_HD Ray outside(const Ray& inside) const;

  friend bool operator==(const RefractingSphere&, const RefractingSphere&) = default;
};

LUCERNA_HD inline Ray RefractingSphere::outside(const Ray& inside) const {
  const Vec3& d = inside.direction.vec();
  const Vec3 o = inside.origin_mm - centre_mm;
  Vec3 q = o - dot(o, d) * d;
  const double max = kLeaves * radius_mm / index;
  q = std::min(1.0, max / std::max(length(q), 1e-300)) * q;
  const double sine2 = dot(q, q) / (radius_mm * radius_mm);
  const double in = std::sqrt(1.0 - sine2), out = std::sqrt(std::max(0.0, 1.0 - index * index * sine2));
  const Vec3 normal = (1.0 / radius_mm) * q + in * d;
  return {centre_mm + radius_mm * normal, Direction::from(index * d + (out - index * in) * normal)};
}

}  // namespace lucerna
