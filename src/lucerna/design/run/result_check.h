// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/run/design.h"

namespace lucerna {

/// What of the source may be behind a mirror beyond what the given mirror leaves there.
inline constexpr double kMaxBehind = 1e-3;

/// Share of the rays (of the first that are enough to tell) that begin behind a mirror.
double share_behind(const DesignShape& shape, const DesignRays& rays);

/// Fills in what a finished design says of `result.shape`: its error and the start's, where the light goes
/// (by validate(): fresh rays through the exported mesh), the limits as found, and the remarks. At most
/// `max_rays` rays; `max_s` stops them earlier. `fit` gives the target's bins for the bound of the étendue.
void check_result(const DesignProblem& problem, const DesignOptions& options, const FitProblem& fit,
                  std::uint64_t max_rays, double max_s, DesignResult& result, Progress& progress);

}  // namespace lucerna
