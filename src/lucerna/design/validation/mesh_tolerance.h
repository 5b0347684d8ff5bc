// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>

#include "lucerna/cad.h"
#include "lucerna/design/validation/error_boxes.h"

namespace lucerna {

/// What the facets of a mirror at `mirror_mm` (luminaire frame) may be off by, where its light is compared
/// with `target` (flux per cell, box_target): facets blur light by about their slope, and that may change the
/// target by 0.15 % of itself (relative L2 in the boxes), and may be a fifth of a box as the mirror sees it.
/// At most kOpticalTolerance's slope and at least half of that. Measured: docs/benchmarks/design.md.
CadTolerance mesh_tolerance(const ErrorBoxes& boxes, std::span<const double> target, const Vec3& mirror_mm);

namespace detail {
/// Relative L2 change of a target whose light is blurred, for each square degree of the blur's variance in
/// each of the two directions (small blurs). A box is `box_deg` wide and high.
double change_per_deg2(const ErrorBoxes& boxes, std::span<const double> target,
                       const std::array<double, 2>& box_deg);
}  // namespace detail

}  // namespace lucerna
