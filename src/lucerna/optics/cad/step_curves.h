// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lucerna/optics/cad/step_writer.h"
#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/reflector.h"

namespace lucerna {

// Our splines as STEP has them: knots with full multiplicity at both ends.

/// Coefficients on such knots, from those on equal knots. A coefficient is the polynomial's blossom at three
/// neighbouring knots (L. Ramshaw, "Blossoms are polar forms", 1989): only two at each end change.
std::vector<double> clamped_coefficients(const std::vector<double>& c);

/// Knots of a row: where they are, and the clamped coefficients of x and x^2.
struct ClampedRow {
  explicit ClampedRow(const KnotRow& row);

  std::vector<double> knots, x, square;
  std::vector<int> multiplicity;
};

/// The cubic with continuous tangent through places and slopes of a curve on [a, b], in so many equal pieces
/// that its middles are within 1e-6 mm.
/// Throws InputError where 16384 pieces are not enough.
StepCurve step_cubic(double a, double b, const std::function<std::array<Vec3, 2>(double)>& curve);

/// A quarter of the circle of radius r about the axis, on a surface; quadrant 0 begins at +x.
StepCurve step_quarter(const HeightSurface& surface, double r_mm, int quadrant);

/// The very surface, with x and y as its parameters.
StepSurface step_surface(const BsplineShape& shape);

}  // namespace lucerna
