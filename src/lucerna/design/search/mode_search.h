// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/design/fit/fit_problem.h"
#include "lucerna/design/fit/found_shape.h"

namespace lucerna {

/// Deepens, shifts, tilts and bends a free form by those of nine low modes (height, tilts, defocus,
/// astigmatisms, comas, spherical, less what a symmetry forbids) that bring its light nearest to the target
/// in coarse bins. CMA-ES looks for them without derivatives, within about a third of the radius. The result
/// has the knots of `given` and depends on the arguments alone; other seeds end elsewhere. For mirrors only,
/// not for troughs and mirrors of revolution. One to two seconds.
FoundShape mode_search(const FitProblem& problem, const DesignShape& given, std::uint64_t seed);

}  // namespace lucerna
