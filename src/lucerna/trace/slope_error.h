// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/core/direction.h"

namespace lucerna {

/// Which reflection a tilt is drawn for: the ray's place in its source's stream and how often it was
/// reflected before. The same in every engine, for any cut of the rays.
struct ReflectionKey {
  std::uint64_t sequence_seed = 0, ray = 0;
  int bounce = 0;
};

/// `normal` tilted by a Gaussian angle of standard deviation `slope_error_rad` about each of two
/// perpendicular axes (a random stream of its own, independent of the sequence that emits). Thread safe.
Direction tilted_normal(const Direction& normal, double slope_error_rad, const ReflectionKey& key);

}  // namespace lucerna
