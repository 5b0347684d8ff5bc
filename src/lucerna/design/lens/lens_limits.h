// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/design/lens/lens_shape.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

/// What a lens must not be: [design.limits] of a project with `free_sides`.
struct LensLimits {
  std::optional<double> max_diameter_mm, max_height_mm;
  /// Between faces that do not meet, and between its two points on the axis.
  std::optional<double> min_thickness_mm;
  /// Between a free face and the axis, along which a mould opens.
  std::optional<double> min_draft_deg;
  /// Of free forms.
  ShapeSymmetry symmetry = ShapeSymmetry::none;

  bool any() const { return max_diameter_mm || max_height_mm || min_thickness_mm || min_draft_deg; }
};

/// Of a body that stays closed, where the project does not say more.
inline constexpr double kMinThickness_mm = 0.05;

/// Squares of excesses over a small margin (0.02 mm, 0.01 of a sine), from one margin within a limit on,
/// at points of the curve; 0 where all hold. `signs`: where faces look to at the start (`draft_signs`). Adds
/// its residuals to `rows`. O(points^2).
double lens_limits_cost(const LensLimits& limits, const LensShape& shape, const std::vector<double>& signs,
                        ResidualRows& rows);

/// Of each face, 1 where it looks along +z in its middle, -1 along -z.
std::vector<double> draft_signs(const LensShape& shape);

/// Whether a limit is held, but for rounding.
LimitCheck at_most(const char* limit, double allowed, double found);
LimitCheck at_least(const char* limit, double allowed, double found);

/// Every limit that is set as found on the curve, at points ten times as close as a fit's.
std::vector<LimitCheck> check_lens_limits(const LensLimits& limits, const LensShape& shape,
                                          const std::vector<double>& signs);

}  // namespace lucerna
