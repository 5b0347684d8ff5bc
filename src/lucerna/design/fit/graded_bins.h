// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/problem/target_rectangle.h"

namespace lucerna {

/// Bins that a free form is fitted in, in the mirror's frame: `inner` x `inner` over the target's rectangle
/// widened by `widen`, and growing ones around them as far as light can go (`outer` on each side; 0: none).
TentBins graded_bins(const TargetRectangle& rectangle, const Frame& mirror_from_world, int inner,
                     double widen, int outer = 8);

/// 1 for bins whose centre lies in the rectangle, else 0.
Eigen::VectorXd in_rectangle(const TentBins& bins, const TargetRectangle& rectangle);

}  // namespace lucerna
