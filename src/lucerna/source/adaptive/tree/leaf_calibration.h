// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <vector>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"
#include "lucerna/source/adaptive/tree/tree_marginals.h"

namespace lucerna {

/// A seventh of each leaf's share, in the root mean square.
inline constexpr double kMaxDivergence_nats = 0.01;

/// Kullback and Leibler's divergence of leaf shares, the mean over the trees: nats per ray by which rays that
/// are shared out as `from` are less likely with `to`.
double divergence_nats(std::span<const std::vector<double>> from, std::span<const std::vector<double>> to);

/// Moves the shares of all leaves of a chart's trees (in preorder, each tree's sum 1) so that the sums of the
/// trees' mean over every pair of axes come to the shrunken shares of its rays. Changes nothing where the
/// rays do not contradict the trees. Ends early where leaves have moved by more than kMaxDivergence_nats:
/// sums finer than the leaves can only be had by shares that the leaves' own rays contradict. Deterministic
/// for any number of threads.
void calibrate_leaves(std::span<const DensityTree> trees, const TreeBox& box, const TreeMarginals& rays,
                      std::span<std::vector<double>> leaf_shares);

/// By how many standard deviations (axis_contradiction) the rays contradict the mean of the trees in place,
/// and in direction.
std::array<double, 2> contradictions(std::span<const DensityTree> trees, const TreeBox& box,
                                     const TreeMarginals& rays,
                                     std::span<const std::vector<double>> leaf_shares);

}  // namespace lucerna
