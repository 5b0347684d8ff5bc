// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"
#include "lucerna/source/adaptive/tree/tree_marginals.h"

namespace lucerna {

/// Moves the shares of all leaves of a chart's trees (in preorder, each tree's sum 1) so that the sums of the
/// trees' mean over every pair of axes come to the shrunken shares of its rays. Changes nothing where the
/// rays do not contradict the trees. Deterministic for any number of threads.
void calibrate_leaves(std::span<const DensityTree> trees, const TreeBox& box, const TreeMarginals& rays,
                      std::span<std::vector<double>> leaf_shares);

/// By how many standard deviations (axis_contradiction) the rays contradict the mean of the trees in place,
/// and in direction.
std::array<double, 2> contradictions(std::span<const DensityTree> trees, const TreeBox& box,
                                     const TreeMarginals& rays,
                                     std::span<const std::vector<double>> leaf_shares);

}  // namespace lucerna
