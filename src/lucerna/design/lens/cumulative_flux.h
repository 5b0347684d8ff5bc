// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/problem/target_mode.h"
#include "lucerna/design/solver/least_squares.h"

namespace lucerna {

/// Adds `weight` times the mean square of what light within each ring differs from the target's, as a share
/// of the target's light. Light in the wrong ring costs the more the farther it is from where it is wanted,
/// as in transport, so steps lead from far away where the rings themselves show none. In shape mode all light
/// is scaled to the target's. Bins are rings, from the axis out; the evaluation has derivatives.
void add_cumulative_flux(const Evaluation& e, const Eigen::VectorXd& target, TargetMode mode, double weight,
                         NormalEquations& equations);

}  // namespace lucerna
