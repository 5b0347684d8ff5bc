// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/mesh_tolerance.h"

#include <algorithm>
#include <cmath>

#include "lucerna/design/validation/error_boxes.h"

namespace lucerna {

namespace {

/// Of a box, and the least share of kOpticalTolerance's slope: STL files grow with its inverse square.
constexpr double kShareOfBox = 0.2, kLeast = 0.5;

/// Angle of the shorter side of a box, seen from `mirror_mm`.
double box_deg(const TargetRectangle& rectangle, const Vec3& mirror_mm) {
  const double side = std::min(rectangle.width(), rectangle.height()) / kErrorBoxes;
  if (!rectangle.is_plane) return degrees(side);
  const Frame& plane = rectangle.world_from_rectangle;
  return degrees(std::atan2(side, std::abs(dot(mirror_mm - plane.origin_mm(), plane.ez()))));
}

}  // namespace

CadTolerance mesh_tolerance(const TargetRectangle& rectangle, const Vec3& mirror_mm) {
  CadTolerance tolerance = kOpticalTolerance;
  const double share = kShareOfBox * box_deg(rectangle, mirror_mm) / tolerance.slope_deg;
  tolerance.slope_deg *= std::clamp(share, kLeast, 1.0);
  return tolerance;
}

}  // namespace lucerna
