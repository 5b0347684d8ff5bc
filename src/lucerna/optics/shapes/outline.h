// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace lucerna {

// The closed outline of a body that turns about the z axis: corners (r, z), joined by straight sides, or by
// curves where they turn little.

using OutlinePoint = std::array<double, 2>;  // r, z in mm

/// Throws InputError for fewer than three corners, a radius below 0, a number that is not finite, two equal
/// corners in a row, an outline that crosses itself or has no area. O(corners^2).
void check_outline(std::span<const OutlinePoint> corners_mm);

/// The corners, counter-clockwise with r to the right and z up: outside is to the right of every side.
std::vector<OutlinePoint> counter_clockwise(std::span<const OutlinePoint> corners_mm);

/// How far the outline turns at corner `i`, in degrees, 0 to 180; on the axis it goes on as its mirror image.
double turn_deg(std::span<const OutlinePoint> corners_mm, std::size_t i);

/// A straight piece of an outline, and the unit normals, outward, of the curve that it stands for at its
/// ends.
struct OutlineSide {
  OutlinePoint from, to, from_normal, to_normal;
  /// The corner of the counter-clockwise outline at which the side that it is a piece of begins.
  std::size_t corner = 0;
};

/// The outline in straight pieces, counter-clockwise, without those along the axis. Between corners that turn
/// by more than `smooth_below_deg` it is the C2 cubic spline through the corners over the length of the
/// chords, which is level and even at the axis if it turns by less there; a spline of one side is straight.
/// Pieces leave the curve by at most `tolerance_mm` > 0, each side of the outline in 1 to 1024 of them.
/// Throws InputError as check_outline does, and for a spline that crosses itself.
std::vector<OutlineSide> outline_sides(std::span<const OutlinePoint> corners_mm, double smooth_below_deg,
                                       double tolerance_mm);

/// By corners of the counter-clockwise outline: does the side that begins there belong to a face, from one
/// edge or the axis to the next, of which one of `sides` is a part? These are numbered from 0 as
/// `corners_mm` has them, side 0 from the first corner to the second. Throws InputError for a side that is
/// not there or lies on the axis.
std::vector<bool> sides_of_faces(std::span<const OutlinePoint> corners_mm, double smooth_below_deg,
                                 std::span<const std::size_t> sides);

/// The largest distance of a corner from the origin, mm.
double outline_reach_mm(std::span<const OutlinePoint> corners_mm);

}  // namespace lucerna
