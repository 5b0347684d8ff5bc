// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "lucerna/core/parallel/peers.h"
#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/evaluation/sparse_jacobian.h"

/// Derivatives of an evaluation that several processes make together (peers.h). Parts are what one process
/// sums apart, and each process has its own of them (`own_items`). A row of the Jacobian is the sum of its
/// parts in their order. So bins are dealt to the processes: each gets the parts of its bins from the others,
/// adds them, and sends the rows to all. All functions are collective.
namespace lucerna {

/// What all processes are to agree on before an evaluation.
std::uint64_t state_key(const DesignShape& shape, std::size_t bins, const EvaluationOptions& options);

/// `fold_jacobians` of parts of which this process has its own; the others are empty.
BinJacobian shared_jacobian(Peers& peers, const std::vector<std::vector<double>>& parts, std::size_t bins,
                            const DesignShape& shape, double scale);

/// All parts, with the blocks of this process's bins only, in the order in which they were added.
std::vector<SparseSums> exchanged_blocks(Peers& peers, const std::vector<SparseSums>& parts,
                                         std::size_t bins);

/// Puts the rows of all bins in place of those of this process.
void share_rows(Peers& peers, SparseDerivatives& derivatives);

}  // namespace lucerna
