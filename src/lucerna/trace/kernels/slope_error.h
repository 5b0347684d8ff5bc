// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "lucerna/geometry.h"
#include "lucerna/random.h"

namespace lucerna {

/// Which reflection a tilt is drawn for: the ray's place in its source's stream and how often it was
/// reflected before. The same in every engine, for any cut of the rays.
struct ReflectionKey {
  std::uint64_t sequence_seed = 0, ray = 0;
  int bounce = 0;
};

/// `normal` tilted by a Gaussian angle of standard deviation `slope_error_rad` about each of two
/// perpendicular axes (a random stream of its own, independent of the sequence that emits). Thread safe.
LUCERNA_HD inline Direction tilted_normal(const Direction& normal, double slope_error_rad,
                                          const ReflectionKey& key) {
  // Streams below 2^16 belong to whoever emits with the same seed.
  Rng rng(key.sequence_seed, key.ray, 0x10000u + static_cast<std::uint32_t>(key.bounce));
  const double radius = slope_error_rad * std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
  const double angle = 2.0 * std::numbers::pi * rng.uniform();
  const Frame tangent = Frame::from_z(normal);
  return Direction::from(normal.vec() + (radius * std::cos(angle)) * tangent.ex() +
                         (radius * std::sin(angle)) * tangent.ey());
}

}  // namespace lucerna
