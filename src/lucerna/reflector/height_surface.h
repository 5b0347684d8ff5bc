// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// Height and exact gradient of a surface z = h(x, y) at one place.
struct SurfacePoint {
  double z_mm = 0.0;
  double dzdx = 0.0, dzdy = 0.0;
};

/// A closed range of heights.
struct HeightRange {
  double low_mm = 0.0, high_mm = 0.0;
};

/// An axis-parallel rectangle in the reflector's xy plane.
struct Rectangle {
  double x0_mm = 0.0, x1_mm = 0.0, y0_mm = 0.0, y1_mm = 0.0;
};

/// The shape of a mirror as a height over the xy plane of its own frame: vertex at the origin, opening along
/// +z; the side towards +z reflects. Defined for every (x, y): beyond the region that it describes it
/// continues steadily, so that cells cut by an aperture's rim have heights. Immutable and thread safe.
class HeightSurface {
 public:
  virtual ~HeightSurface() = default;

  /// Height and gradient at (x, y).
  virtual SurfacePoint at(double x_mm, double y_mm) const = 0;

  /// A range that holds the height at every point of `region`; as tight as is cheap. What hierarchies are
  /// built from.
  virtual HeightRange range(const Rectangle& region) const = 0;
};

}  // namespace lucerna
