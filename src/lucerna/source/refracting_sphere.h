// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/core/frame.h"

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

  bool exists() const { return radius_mm > 0.0; }
  /// dG outside over dG inside.
  double etendue_ratio() const { return exists() ? index * index : 1.0; }

  /// The ray inside, from the point where it leaves the ball; nothing for lines that miss the ball.
  std::optional<Ray> inside(const Ray& outside) const;
  /// The ray outside, from the point where it leaves the ball. Lines that would be reflected back inside are
  /// first moved towards the centre until they leave along the surface (leaves of a model reach a little too
  /// far).
  Ray outside(const Ray& inside) const;

  friend bool operator==(const RefractingSphere&, const RefractingSphere&) = default;
};

}  // namespace lucerna
