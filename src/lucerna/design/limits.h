// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/least_squares.h"

namespace lucerna {

/// What the height limit costs, added to the normal equations too unless they are null: at points over the
/// aperture, the square of the excess of z - z(0, 0) over `max_height_mm`, such that 0.02 mm too much costs
/// as much as an error of 100 %. The limit is drawn in by 0.02 mm, so that what is left of an excess does not
/// break it. Linear in the parameters, exact derivatives.
double height_limit(const DesignShape& shape, double max_height_mm, NormalEquations* equations);

/// Adds weight * (1 - F / reference)^2, F the light in the bins, with its derivative.
void add_flux_term(const Evaluation& e, double weight, double reference, NormalEquations& equations);

}  // namespace lucerna
