// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "lucerna/ray_comparison.h"

namespace lucerna {

/// Share of the flux that a view's window holds (docs/theory/comparison.md).
inline constexpr double kViewWindowShare = 0.99;

struct WeightedValue {
  double value, weight;
};

/// Smallest value with at least `share` of the weight at or below it; 0 for none. Sorts `items`.
double weighted_quantile(std::vector<WeightedValue>& items, double share);

/// What the rays look like in a view, as Views::coordinates has it.
using WindowPoints = std::vector<std::array<double, 4>>;

/// Fits `window` (dimensions and cells are set) to the points: centred on the medians, its proportions from
/// the axes' own tails, scaled to hold kViewWindowShare of the weights. `min[k]` is the smallest half width
/// of axis k.
void fit_view_window(const WindowPoints& points, const std::vector<double>& weights,
                     const std::array<double, 4>& min, ViewWindow& window);

/// The cell of a window that a place falls in (the last axis runs fastest), or the number of cells if none.
std::size_t cell_of(const ViewWindow& window, const std::array<double, 4>& place);

/// One of at most `max` rays out of each of as many equal runs, by chance (seed 0); all if there are fewer.
std::vector<std::size_t> stratified_choice(std::size_t rays, std::size_t max);

}  // namespace lucerna
