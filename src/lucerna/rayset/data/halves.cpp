// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/halves.h"

#include <algorithm>

namespace lucerna {

std::array<RayBlock, 2> ray_halves(const RayBlock& rays, std::uint64_t seed) {
  std::array<RayBlock, 2> halves;
  for (RayBlock& half : halves) half.resize(0, rays.extra.size());
  for (std::size_t i = 0; i < rays.size(); ++i) halves[in_second_half(seed, i) ? 1 : 0].append(rays, i);
  return halves;
}

bool has_flux(const RayBlock& rays) {
  return std::ranges::any_of(rays.weight, [](float w) { return w > 0.0f; });
}

}  // namespace lucerna
