// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/solver/least_squares.h"

namespace lucerna {

/// What a share of the sources' flux lacks of `reference` > 0, over that. More light than that lacks none: a
/// reference is what the given optic lets through, and a better one may let through more.
inline double missing_light(double light, double reference) { return std::max(0.0, 1.0 - light / reference); }

/// Adds weight * missing_light^2 of the light in the bins, with its derivative.
void add_missing_light(const Evaluation& e, double weight, double reference, NormalEquations& equations);

}  // namespace lucerna
