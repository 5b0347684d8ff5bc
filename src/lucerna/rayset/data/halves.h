// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

#include "lucerna/random.h"
#include "lucerna/rays.h"

namespace lucerna {

/// Beside the seeds that rays are drawn with: halves by the numbers that placed the rays would be two places.
inline constexpr std::uint64_t kHalvesSeed = 0x68656c64;

/// Is ray `index` in the second of two halves? By chance and not in turns: files may have a pattern, such as
/// the dies of a lamp one after the other, and halves of it would be two sources. The same for the same seed.
inline bool in_second_half(std::uint64_t seed, std::uint64_t index) {
  return Rng(seed ^ kHalvesSeed, index).uniform() >= 0.5;
}

/// Both halves, in the rays' order, with all columns. Of a few rays one may have none.
std::array<RayBlock, 2> ray_halves(const RayBlock& rays, std::uint64_t seed);

/// Is there a ray whose weight is above 0?
bool has_flux(const RayBlock& rays);

}  // namespace lucerna
