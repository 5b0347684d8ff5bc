// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/design_shape.h"
#include "lucerna/design/least_squares.h"

namespace lucerna {

/// How far a shape's spline is from one of constant curvature: weight * mean over the coefficients of (third
/// difference / knot step)^2 along both directions, which is the square of a change of slope from knot to
/// knot. Adds gradient and Hessian to `equations` unless null; returns the cost. While bins are so coarse
/// that they do not tell folded light from smooth, this does.
double roughness(const DesignShape& shape, double weight, NormalEquations* equations);

}  // namespace lucerna
