// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/geometry.h"
#include "lucerna/intensity.h"

namespace lucerna {

struct DesignTarget;
struct PlaneTarget;

/// Where the error of a design is measured: a rectangle of direction cosines about an axis of the luminaire
/// frame, or of places on a plane. It holds 99.5 % of the target's flux along each of its two axes: a quarter
/// of a per cent is cut off at each of the four sides.
struct TargetRectangle {
  /// Directions: +z is that axis of the luminaire frame (+-x, +-y, +-z) which is nearest to the target's mean
  /// direction, x and y are the two others; never a tilted axis, whose hemisphere would reach beyond the
  /// horizon. Places: the frame of the plane, its lit side towards +z.
  Frame world_from_rectangle;
  bool is_plane = false;
  /// Direction cosines along x and y, within [-1, 1]; or places in mm from the origin of the plane's frame.
  double u_min = -1.0, u_max = 1.0, v_min = -1.0, v_max = 1.0;

  double width() const { return u_max - u_min; }
  double height() const { return v_max - v_min; }
  friend bool operator==(const TargetRectangle&, const TargetRectangle&) = default;
};

/// Of light in directions. Light on the far side of the sphere (away from the axis) has no place in it and
/// does not count for its size. No side is shorter than 1e-4. Throws InputError on a grid that breaks its
/// rules and on a target without light. Deterministic; thread safe; about 20 ms.
TargetRectangle target_rectangle(const IntensityDistribution& target);
/// Of illuminance on a plane. Throws InputError on a dark map.
TargetRectangle target_rectangle(const PlaneTarget& target);
/// Of the plane where the target has one, else of its distribution.
TargetRectangle target_rectangle(const DesignTarget& target);

}  // namespace lucerna
