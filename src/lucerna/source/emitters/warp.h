// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "lucerna/geometry.h"

/// Maps of the unit square onto the shapes that emitters need; each keeps areas (up to the density it names),
/// so that evenly spread points stay evenly spread. u, v in [0, 1).
namespace lucerna::warp {

/// Uniform on the unit disk, concentric: squares go to squarish sectors, which Sobol points like
/// (P. Shirley and K. Chiu, "A low distortion map between disk and square", 1997).
LUCERNA_HD inline Vec3 disk(double u, double v) {
  const double a = 2.0 * u - 1.0, b = 2.0 * v - 1.0;
  if (a == 0.0 && b == 0.0) return {};
  const bool steep = std::abs(b) > std::abs(a);
  const double r = steep ? b : a;
  const double phi =
      steep ? 0.5 * std::numbers::pi - 0.25 * std::numbers::pi * (a / b) : 0.25 * std::numbers::pi * (b / a);
  return {r * std::cos(phi), r * std::sin(phi), 0.0};
}

/// Density cos(theta) / pi per solid angle about +z: Lambert's law, uniform in projected solid angle.
LUCERNA_HD inline Direction cosine_hemisphere(double u, double v) {
  const Vec3 d = disk(u, v);
  return Direction::from_unit({d.x, d.y, std::sqrt(std::max(0.0, 1.0 - d.x * d.x - d.y * d.y))});
}

/// The direction with the given cosine to +z, at azimuth 2 pi v.
LUCERNA_HD inline Direction at_cosine(double cosine, double v) {
  const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine)), phi = 2.0 * std::numbers::pi * v;
  return Direction::from_unit({sine * std::cos(phi), sine * std::sin(phi), cosine});
}

/// Density 1 / (4 pi) per solid angle.
LUCERNA_HD inline Direction sphere(double u, double v) { return at_cosine(1.0 - 2.0 * u, v); }

/// Density (n + 1) / (2 pi) cos^n(theta) per solid angle about +z: the Phong lobe as E. Lafortune and Y.
/// Willems sample it ("Using the modified Phong reflectance model for physically based rendering", 1994).
LUCERNA_HD inline Direction phong_lobe(double exponent, double u, double v) {
  return at_cosine(std::pow(1.0 - u, 1.0 / (exponent + 1.0)), v);
}

/// `d`, given about +z, turned so that it is about `normal`.
LUCERNA_HD inline Direction about(const Direction& normal, const Direction& d) {
  return Frame::from_z(normal).direction(d);
}

}  // namespace lucerna::warp
