// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/optics/shapes/outline.h"
#include "lucerna/optics/shapes/outline_curve.h"
#include "lucerna/reflector.h"

namespace lucerna {

// The open outline of a body whose top is a height field: corners (r, z) from the axis to the upper end of a
// wall, as `Solid::face` says; or from the upper end of an inner wall, whose bottom within is a height field
// too, as `Solid::bottom_face` says. What lies between inner wall or axis and outer wall is its base.

/// Throws InputError for an outline that does not begin on the axis, or with a bottom face in a wall that
/// runs downward; that does not end in a wall; that check_outline refuses once it is closed; whose curve
/// crosses itself or turns into a wall by no more than `smooth_below_deg`; and for a face that is not finite,
/// is not above what lies below it, or whose rim is not above the wall's lower end. Faces are looked at at 64
/// x 64 points, lenslets of an array by their lowest place. O(corners^2 + 4096 sides).
void check_faced_outline(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces,
                         double smooth_below_deg);

/// Whether the outline begins in a wall about a bottom face.
inline bool has_inner_wall(std::span<const OutlinePoint> corners_mm) { return corners_mm.front()[0] > 0.0; }

/// The curves of the base, without walls, and the corners that they count: those of the outline, closed by a
/// lid above the face and by a floor about the axis. `corners_mm` as check_faced_outline takes them.
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

/// The largest distance of a corner, of a face's centre and of its rim from the origin, mm.
double faced_reach_mm(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces);

}  // namespace lucerna
