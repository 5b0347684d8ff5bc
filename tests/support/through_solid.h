// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <stdexcept>

#include "lucerna/trace/engines/solid_tracer.h"

namespace lucerna::test {

/// What becomes of a ray that meets the solid; `number` chooses its random numbers.
inline GlassPassage through_solid(const SolidTracer& tracer, const Ray& ray, std::uint64_t number) {
  const auto hit = tracer.first_hit(ray, 1e9, false);
  if (!hit) throw std::runtime_error("a ray misses the solid");
  return tracer.pass(ray, *hit, {3, number, 0}, 0.0F);
}

/// Where a ray is in the plane z.
inline Vec3 at_height(const Ray& ray, double z_mm) {
  return ray.origin_mm + ((z_mm - ray.origin_mm.z) / ray.direction.z()) * ray.direction.vec();
}

}  // namespace lucerna::test
