// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/fit_problem.h"
#include "lucerna/design/initial/transport_guess.h"

namespace lucerna {

/// The light that the mirror has to make: the target in fine bins, less what leaves the source without a
/// reflection past `shape` (unless the problem leaves that out). Directions in the mirror's frame; for a
/// plane, as seen from the mirror. Traces 65 k rays.
std::vector<DirectedFlux> target_light(const FitProblem& problem, const DesignShape& shape);

/// A trace of a shape without derivatives, of the first `rays` of the problem's rays, which must be there.
/// Thread safe.
Evaluation evaluate_start(const FitProblem& problem, const DesignShape& shape, const TentBins& bins,
                          std::uint64_t rays);

/// Cost of a shape that was traced so.
double fit_cost(const FitProblem& problem, const DesignShape& shape, const Evaluation& e,
                const TentBins& bins, const Eigen::VectorXd& target);

/// Cost of a shape in bins: relative RMS^2 and what limits and lost light add, as `Fit` counts it. Traces the
/// first `rays` of the problem's rays, which must be there. Thread safe.
double fit_cost(const FitProblem& problem, const DesignShape& shape, const TentBins& bins,
                const Eigen::VectorXd& target, std::uint64_t rays);

/// The trough that a point source would need for the target, with the knots of `family`; nothing where there
/// is none (trough_balance). `choice.sign` -1: light of one side goes out to that side; +1: the rays cross.
std::optional<DesignShape> trough_guess(const FitProblem& problem, const DesignShape& family,
                                        const TransportChoice& choice);

/// Where a fit may begin: the given shape, and what a point source would need (zero_etendue.h) with the
/// vertex where it is given and at other distances, the cheapest first in a third of the problem's bins. The
/// given shape begins with few knots, the others with all. Progress phase "starts".
std::vector<InitialGuess> initial_guesses(const FitProblem& problem, const DesignShape& shape,
                                          Progress& progress = no_progress());

}  // namespace lucerna
