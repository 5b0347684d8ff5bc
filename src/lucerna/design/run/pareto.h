// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/run/design_problem.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/progress.h"

namespace lucerna {

struct DesignOptions;

/// Throws InputError, naming "pareto", for a problem without a trade between error and light: a mirror of
/// revolution, an optimizer other than auto, a target of absolute values or of zones alone.
void check_pareto(const DesignProblem& problem);

/// The trade between error and light in the target's rectangle. The light that a mirror catches follows
/// mostly from where its vertex is, so point sources' mirrors of several vertex distances are fitted, each
/// with the problem's light weight and with ten times that, and `found` with both; all are validated. Only
/// those that no other beats in both are returned, in the order of their light. For problems that
/// `check_pareto` passes. One to two minutes on two cores. Progress phase "pareto". Throws Interrupted when
/// asked to stop.
std::vector<ParetoPoint> pareto_front(const DesignProblem& problem, const DesignShape& found,
                                      const DesignOptions& options, Progress& progress = no_progress());

}  // namespace lucerna
