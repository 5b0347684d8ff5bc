// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/compression/exact_trees.h"

#include <algorithm>
#include <utility>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/adaptive/tree/leaf_calibration.h"

namespace lucerna {

namespace {

/// The penalty is chosen for a quarter of all cuts: four times as many find as much by chance with ln 4 nats
/// more.
constexpr double kFineNats = 1.3862943611198906;

}  // namespace

ExactTrees exact_trees(const std::vector<GrownTree>& from, const TreeBox& box, double penalty_nats,
                       std::size_t trees, const TreeMarginals* calibration) {
  const std::size_t n = std::min(from.size(), trees);
  ExactTrees to{std::vector<DensityTree>(n), std::vector<std::vector<double>>(n)};
  parallel_blocks(n, 1, [&](std::size_t t, std::size_t) {
    const bool fine = from.size() == 2 && t < kFineOfTwo;
    PrunedTree pruned = prune_exactly(from[t], penalty_nats + (fine ? kFineNats : 0.0));
    to.trees[t] = std::move(pruned.tree), to.leaf_shares[t] = std::move(pruned.leaf_shares);
  });
  if (calibration) calibrate_leaves(to.trees, box, *calibration, to.leaf_shares);
  return to;
}

}  // namespace lucerna
