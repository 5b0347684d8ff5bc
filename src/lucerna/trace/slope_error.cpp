// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/slope_error.h"

#include <cmath>

#include "lucerna/core/frame.h"
#include "lucerna/core/random.h"

namespace lucerna {

Direction tilted_normal(const Direction& normal, double slope_error_rad, const ReflectionKey& key) {
  // Streams below 2^16 belong to whoever emits with the same seed.
  Rng rng(key.sequence_seed, key.ray, 0x10000u + static_cast<std::uint32_t>(key.bounce));
  const double radius = slope_error_rad * std::sqrt(-2.0 * std::log(1.0 - rng.uniform()));
  const double angle = 2.0 * std::numbers::pi * rng.uniform();
  const Frame tangent = Frame::from_z(normal);
  return Direction::from(normal.vec() + (radius * std::cos(angle)) * tangent.ex() +
                         (radius * std::sin(angle)) * tangent.ey());
}

}  // namespace lucerna
