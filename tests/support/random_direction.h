// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>

#include "lucerna/geometry.h"
#include "lucerna/random.h"

namespace lucerna::test {

/// Even over the sphere, from the next two numbers of `rng`.
inline Direction random_direction(Rng& rng) {
  const double z = 2.0 * rng.uniform() - 1.0, phi = 2.0 * std::numbers::pi * rng.uniform();
  const double across = std::sqrt(1.0 - z * z);
  return Direction::from({across * std::cos(phi), across * std::sin(phi), z});
}

}  // namespace lucerna::test
