// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/fit/fit_problem.h"
#include "lucerna/design/fit/found_shape.h"

namespace lucerna {

/// FitProblem::flux_weight of a `Fit`: in shape mode a tenth of the light beside the window counts as an
/// error of 4.5 %.
inline constexpr double kFitFluxWeight = 0.2;

/// The same problem with that weight, where lost light has one.
FitProblem with_fit_flux_weight(FitProblem problem);

/// Most intervals along a side of a mirror that `approach` works on.
inline constexpr int kApproachIntervals = 20;

/// Whether a mirror is a matter for `approach`.
bool has_few_knots(const DesignShape& shape);

/// Brings a mirror of few knots near a target: coarse bins, large scales and few rays first, which show a way
/// where fine bins see nothing but ripples, then perturbed restarts while it is near but not at the noise
/// (Fit, up to its screening stage). The result has the knots of the start, which has few, and depends on the
/// arguments alone. `max_rays`: of an evaluation. Traces about 2^23 rays at most.
FoundShape approach(const FitProblem& problem, const InitialGuess& start, std::uint64_t max_rays);

}  // namespace lucerna
