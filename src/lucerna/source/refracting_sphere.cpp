// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/refracting_sphere.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// Share of the largest offset at which light still leaves: at the whole of it, it runs along the surface.
constexpr double kLeaves = 1.0 - 1e-9;

}  // namespace

std::optional<Ray> RefractingSphere::inside(const Ray& outside) const {
  const Vec3& d = outside.direction.vec();
  const Vec3 o = outside.origin_mm - centre_mm, q = o - dot(o, d) * d;
  const double sine2 = dot(q, q) / (radius_mm * radius_mm);
  if (sine2 > kLeaves * kLeaves) return std::nullopt;
  const double out = std::sqrt(1.0 - sine2), in = std::sqrt(1.0 - sine2 / (index * index));
  const Vec3 normal = (1.0 / radius_mm) * q + out * d;
  return Ray{centre_mm + radius_mm * normal,
             Direction::from((1.0 / index) * d + (in - out / index) * normal)};
}

Ray RefractingSphere::outside(const Ray& inside) const {
  const Vec3& d = inside.direction.vec();
  const Vec3 o = inside.origin_mm - centre_mm;
  Vec3 q = o - dot(o, d) * d;
  const double most = kLeaves * radius_mm / index;
  q = std::min(1.0, most / std::max(length(q), 1e-300)) * q;
  const double sine2 = dot(q, q) / (radius_mm * radius_mm);
  const double in = std::sqrt(1.0 - sine2), out = std::sqrt(std::max(0.0, 1.0 - index * index * sine2));
  const Vec3 normal = (1.0 / radius_mm) * q + in * d;
  return {centre_mm + radius_mm * normal, Direction::from(index * d + (out - index * in) * normal)};
}

}  // namespace lucerna
