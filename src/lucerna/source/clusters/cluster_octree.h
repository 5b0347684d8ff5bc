// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/rays.h"

namespace lucerna {

/// Rays sorted into the leaves of an octree over their starts.
struct PositionOctree {
  /// Ray numbers, leaf after leaf, in Morton order (equal places in the order of the file).
  std::vector<std::uint32_t> order;
  /// Leaf l holds order[begin[l]] .. order[begin[l + 1] - 1]; never empty.
  std::vector<std::uint32_t> begin;

  std::size_t leaf_count() const { return begin.size() - 1; }
};

/// Splits the cube round the starts of all rays with a weight > 0 while it holds more than a number of rays
/// and its edge is more than 2^-21 of the whole. That number is `min_rays` (>= 1) or, where this gives more
/// than `max_leaves` (>= 1), the least that does not. At least one such ray, at most 2^32 -
/// 1 (InputError). Same result for any number of threads. Needs 16 bytes a ray while it runs.
PositionOctree build_position_octree(const RayBlock& rays, std::size_t min_rays, std::size_t max_leaves);

}  // namespace lucerna
