// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/optics/shapes/outline.h"
#include "lucerna/optics/shapes/outline_curve.h"
#include "lucerna/reflector.h"

namespace lucerna {

// The open outline of a body whose top is a height field: corners (r, z) from the axis to the upper end of a
// wall, as `Solid::face` says. What lies below the wall is its base.

/// Throws InputError for an outline that does not begin on the axis or end in a wall, that check_outline
/// refuses once it is closed above the face, whose curve crosses itself or turns into the wall by no more
/// than `smooth_below_deg`; and for a face that is not finite, is not above the base, or whose rim is not
/// above the wall's lower end. The face is looked at at 64 x 64 points, lenslets of an array by their lowest
/// place. O(corners^2 + 4096 sides).
void check_faced_outline(std::span<const OutlinePoint> corners_mm, const HeightSurface& face,
                         double smooth_below_deg);

/// The curves of the base, from the axis to the wall's lower end, and the corners that they count: those of
/// the outline, closed by a lid above the face. `corners_mm` and `face` as check_faced_outline takes them.
struct FacedBase {
  std::vector<OutlinePoint> corners;
  std::vector<OutlineRun> runs;
};
FacedBase faced_base(std::span<const OutlinePoint> corners_mm, double smooth_below_deg);

/// The base in straight pieces within `tolerance_mm` of its curve, in order.
std::vector<OutlineSide> faced_base_sides(std::span<const OutlinePoint> corners_mm, double smooth_below_deg,
                                          double tolerance_mm);

/// The highest point of such sides at this radius; below all where there is none. O(sides).
double base_height_mm(std::span<const OutlineSide> sides, double r_mm);

/// The largest distance of a corner, of the face's centre and of its rim from the origin, mm.
double faced_reach_mm(std::span<const OutlinePoint> corners_mm, const HeightSurface& face);

}  // namespace lucerna
