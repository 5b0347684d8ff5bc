// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/shape/design_shape.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

/// How far a shape's spline is from one of constant curvature: weight * mean over the coefficients of (third
/// difference / knot step)^2 along both directions, which is the square of a change of slope from knot to
/// knot. Of a free form, a residual counts in proportion to its distance from the axis over the aperture's
/// radius, but `at_axis` at least: around a hole the shape bends within a few knots, so that the ring lights
/// what the hole leaves dark (1: all count alike). Adds its residuals to `rows` unless null; returns the
/// cost. While bins are so coarse that they do not tell folded light from smooth, this does; and it keeps a
/// surface smooth where blurred light does not tell it from a rough one.
double smoothness_penalty(const DesignShape& shape, double weight, double at_axis, ResidualRows* rows);

}  // namespace lucerna
