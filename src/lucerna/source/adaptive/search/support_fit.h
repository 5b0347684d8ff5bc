// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/rays.h"
#include "lucerna/source/adaptive/charts/support.h"
#include "lucerna/source/adaptive/tree/adaptive_tree.h"

namespace lucerna {

/// A support with the part of it that a layer uses: lines beyond `limits` (one box per chart) are another
/// layer's.
struct BoundedSupport {
  Support support;
  std::vector<TreeBox> limits;
};

/// Bounds the coordinates that the support leaves open to where `rays` cross it: the 0.2 % and 99.8 %
/// quantiles, widened by their distance to both sides. Rays that all but graze a plane cross it anywhere.
BoundedSupport bounded(const Support& support, const RayBlock& rays);

/// The rays of one chart, in its numbers, and the smallest box that holds them.
struct ChartItems {
  std::uint32_t chart = 0;
  TreeBox box;
  double weight = 0.0;
  std::vector<TreeItem> items;
};

struct Projection {
  /// Charts that have rays with flux, in the order of their numbers.
  std::vector<ChartItems> charts;
  /// Rays with flux that miss the support or lie beyond its limits.
  std::vector<std::uint32_t> missed;
  double weight = 0.0, missed_weight = 0.0;
};

/// Writes rays down on a support. `weight` holds their weights (a layer's part of each ray). Edges of boxes
/// shorter than `tolerance_mm`, or 1e-6 in a direction's number, become points. 20 bytes a ray; on all
/// threads, the same for any number of them.
Projection project(const RayBlock& rays, std::span<const float> weight, const BoundedSupport& on,
                   double tolerance_mm);

}  // namespace lucerna
