// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "lucerna/geometry.h"
#include "lucerna/trace/kernels/solid_kernels.h"

namespace lucerna {

// Single rays of a batch.

inline void put_ray(const Ray& ray, std::size_t i, SolidBatch& b) {
  const Vec3 &o = ray.origin_mm, &d = ray.direction.vec();
  b.ox[i] = o.x, b.oy[i] = o.y, b.oz[i] = o.z;
  b.dx[i] = d.x, b.dy[i] = d.y, b.dz[i] = d.z;
}
inline Ray ray_of(const SolidBatch& b, std::size_t i) {
  return {{b.ox[i], b.oy[i], b.oz[i]}, Direction::from_unit({b.dx[i], b.dy[i], b.dz[i]})};
}
inline Vec3 outward_of(const SolidBatch& b, std::size_t i) { return {b.nx[i], b.ny[i], b.nz[i]}; }

}  // namespace lucerna
