// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/run/design.h"
#include "lucerna/design/run/time_budget.h"

namespace lucerna {

/// What a search is run for, and who watches it. All must outlive the call.
struct SearchRun {
  const DesignProblem& problem;
  const DesignOptions& options;
  /// Of the checkpoints.
  std::string key;
  TimeBudget& time;
  Progress& progress;
  const DesignObserver& observer;
};

/// Whether a problem's mirror is searched among candidates in fine bins (free_form_search.h): a free form or
/// a trough, unless the project names an optimizer. Else least squares goes from coarse to fine (fit.h).
bool uses_free_form_search(const DesignProblem& problem);

/// Searches the problem's mirror from the start or from the options' checkpoint until nothing is left to
/// gain, the time is spent or progress asks to stop. Fills what `result` says of the search: shape, end,
/// history, checkpoint, evaluations, rays.
void search_mirror(const SearchRun& run, FitProblem& fit, DesignResult& result);

}  // namespace lucerna
