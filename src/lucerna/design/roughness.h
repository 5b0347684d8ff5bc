// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/design_shape.h"
#include "lucerna/design/residual_rows.h"

namespace lucerna {

/// How far a shape's spline is from one of constant curvature: weight * mean over the coefficients of (third
/// difference / knot step)^2 along both directions, which is the square of a change of slope from knot to
/// knot. Adds its residuals to `rows` unless null; returns the cost. While bins are so coarse
/// that they do not tell folded light from smooth, this does.
double roughness(const DesignShape& shape, double weight, ResidualRows* rows);

}  // namespace lucerna
