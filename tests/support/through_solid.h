// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <stdexcept>

#include "lucerna/random.h"
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

/// How far two solids send the same light apart, in a plane 100 mm or so above them.
struct LightDistance {
  /// Rays that passed both, and the largest distance of two.
  int compared = 0;
  double worst_mm = 0.0;
};
/// Of `rays` rays upward from below, within `radius_mm` of the axis. What a boundary reflects is left out.
inline LightDistance light_distance(const SolidTracer& a, const SolidTracer& b, double radius_mm,
                                    std::uint64_t rays) {
  LightDistance out;
  for (std::uint64_t i = 0; i < rays; ++i) {
    Rng rng(11, i);
    const double r = radius_mm * std::sqrt(rng.uniform()), phi = radians(360.0 * rng.uniform());
    const Ray ray{{r * std::cos(phi), r * std::sin(phi), -1.0},
                  Direction::from({0.2 * rng.uniform() - 0.1, 0.2 * rng.uniform() - 0.1, 1.0})};
    const GlassPassage one = through_solid(a, ray, i), other = through_solid(b, ray, i);
    if (!(one.ray.direction.z() > 0.5 && other.ray.direction.z() > 0.5)) continue;
    out.worst_mm = std::max(out.worst_mm, length(at_height(one.ray, 105.0) - at_height(other.ray, 105.0)));
    ++out.compared;
  }
  return out;
}

}  // namespace lucerna::test
