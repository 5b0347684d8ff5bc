// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/ray_comparison.h"

namespace lucerna {

/// Weights that fell in cells, and the sums of their squares; `total_weight` has also what fell in none.
struct CellWeights {
  std::vector<double> weights, squares;
  double total_weight = 0.0;
};

/// How far `test` is from `reference` in the same cells; all zero where the reference has nothing in them.
/// Total weights must be > 0.
ViewDifference cell_difference(const CellWeights& reference, const CellWeights& test,
                               const CellWeights& training);

}  // namespace lucerna
