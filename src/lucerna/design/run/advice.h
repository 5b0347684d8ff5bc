// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/design/run/design_problem.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/progress.h"

namespace lucerna {

struct DesignOptions;

/// The problem with one thing changed.
struct AdviceChange {
  /// As a user would say it: "a tenth wider, 132 mm".
  std::string text;
  DesignProblem problem;
};

/// What is worth a trial: a tenth wider (where the limits allow it), half the hole (likewise), a tenth higher
/// (where the limits say how high), twice the knots (where the project says how many), a free form instead of
/// a mirror of revolution or a trough. Each begins at its family's paraboloid but for height and knots, which
/// begin at the given mirror; within the limits on its form, like every start.
std::vector<AdviceChange> advice_changes(const DesignProblem& problem);

/// Designs the problem again with each of the changes. Each takes as long as the design itself, and `found`
/// is the error of that. Empty for targets of zones alone, which have no error. Ends with what it has when
/// asked to stop. Throws what `design` throws.
std::vector<AdviceTrial> advise(const DesignProblem& problem, const DesignError& found,
                                const DesignOptions& options, Progress& progress = no_progress());

}  // namespace lucerna
