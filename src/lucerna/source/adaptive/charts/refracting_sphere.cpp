// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/refracting_sphere.h"

#include <cmath>

namespace lucerna {

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

}  // namespace lucerna
