// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/design/fit/continuation_schedule.h"
#include "lucerna/design/fit/fit_record.h"
#include "lucerna/design/optimizers/global_search.h"

namespace lucerna {

/// How a basin is looked for before least squares goes down into it: `optimizer = ` of a project.
struct Optimizer {
  std::string name = "auto";
  /// Also begins with what a point source would need (zero_etendue.h).
  bool zero_etendue = true;
  /// Searches the spline with few knots first.
  std::optional<GlobalMethod> global;
};

/// | name | where least squares begins |
/// |---|---|
/// | auto | zero-étendue solutions and the given mirror, the cheapest first; restarts near the best |
/// | least-squares | the given mirror and perturbed copies of it |
/// | tree, annealing, cma-es, direct | the best of that search over few knots, about the cheapest of auto's |
///
/// Throws InputError that lists the names.
Optimizer optimizer(std::string_view name);
/// The names, for messages.
std::string optimizer_names();

/// The box that a global search looks through: the shape with few knots, each parameter within 6 % of the
/// mirror's radius.
struct SearchSpace {
  DesignShape shape;
  SearchBox box;
};
SearchSpace search_space(const DesignShape& about, const ContinuationSchedule& schedule);

/// Evaluations that a search over n parameters gets: 60 n.
int search_evaluations(std::size_t parameters);

/// Called after every batch of a search with its record and the best so far; false ends the search.
using SearchWatch = std::function<bool(const FitRecord&, const DesignShape& best)>;

/// Fills `problem.starts` as the optimizer says. `costs` holds the costs that a search has
/// paid for already (a checkpoint) and is extended with every batch: a search that is taken up again with
/// them ends at the same bits. Candidates of a batch are evaluated in parallel. Returns false if `watch`
/// ended the search; the first start is then the best so far. Progress phases "rays", "starts", "search".
bool prepare_guesses(FitProblem& problem, const DesignShape& shape, const ContinuationSchedule& schedule,
                     const Optimizer& optimizer, std::vector<double>& costs, const SearchWatch& watch,
                     Progress& progress = no_progress());

}  // namespace lucerna
