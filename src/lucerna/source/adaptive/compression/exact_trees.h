// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/source/adaptive/tree/adaptive_tree.h"
#include "lucerna/source/adaptive/tree/tree_marginals.h"

namespace lucerna {

/// Of two trees the first offers all cuts.
inline constexpr std::size_t kFineOfTwo = 1;

/// The trees of a chart without the rounding of their file.
struct ExactTrees {
  std::vector<DensityTree> trees;
  std::vector<std::vector<double>> leaf_shares;
};

/// The first `trees` of `from` pruned by `penalty_nats`, and calibrated where `calibration` is given; on all
/// threads.
ExactTrees exact_trees(const std::vector<GrownTree>& from, const TreeBox& box, double penalty_nats,
                       std::size_t trees, const TreeMarginals* calibration);

}  // namespace lucerna
