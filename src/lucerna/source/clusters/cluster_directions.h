// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/source/clusters/spherical_triangle.h"

namespace lucerna {

/// A ray's direction as the distributions see it: its finest triangle and its weight (mean about 1 over all
/// rays, so that weights count like rays).
struct DirectionSample {
  std::uint32_t code = 0;
  float weight = 0.0f;
};

/// A constant piece of a directional distribution: triangle `code` of level `depth` holds `weight`.
struct DirectionLeaf {
  std::uint32_t code = 0;
  int depth = 0;
  double weight = 0.0;
};

/// The distribution over the hierarchical subdivision that has the largest likelihood of `samples` (ascending
/// codes) less `penalty_nats` for every triangle split into four; splits of no gain that allow a better one
/// below are found too (the tree is pruned from the bottom up: L. Breiman et al., CART, 1984). Leaves ascend
/// and cover the sphere; there are at least the 8 octants. O(samples * depth).
std::vector<DirectionLeaf> direction_tree(std::span<const DirectionSample> samples, double penalty_nats);

/// Log-likelihood of that tree over the 8 octants alone, less the penalties: 0 when no split is worth it.
double direction_gain_nats(std::span<const DirectionSample> samples, double penalty_nats);

}  // namespace lucerna
