// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/intensity.h"

namespace lucerna {

/// A rectangle to be lit, in the luminaire frame (photometric centre at the origin, nadir = -z). The origin
/// of `luminaire_from_plane` is the rectangle's centre, its +z the side that is lit. Illuminance is taken at
/// the centres of nx x ny equal cells.
struct IlluminatedPlane {
  Frame luminaire_from_plane{};
  double size_x_mm = 1000.0, size_y_mm = 1000.0;
  std::size_t nx = 101, ny = 101;

  double cell_x_mm() const { return size_x_mm / static_cast<double>(nx); }
  double cell_y_mm() const { return size_y_mm / static_cast<double>(ny); }
  /// Places of the cell centres in the plane: x of column ix, y of row iy.
  double x_mm(std::size_t ix) const {
    return (static_cast<double>(2 * ix + 1) - static_cast<double>(nx)) * (0.5 * cell_x_mm());
  }
  double y_mm(std::size_t iy) const {
    return (static_cast<double>(2 * iy + 1) - static_cast<double>(ny)) * (0.5 * cell_y_mm());
  }
};

/// Where the plane stands: `distance_mm` from the luminaire in the direction `aim`, facing it. At nadir x
/// and y of the plane are x (C0) and y (C90) of the luminaire; for other directions the plane is carried
/// there by the shortest turn from nadir. Then it turns in its own axes: first about its x by `tilt_x_deg`,
/// then about its new y by `tilt_y_deg`; at 90 and beyond the light falls on the back.
struct PlanePlacement {
  double distance_mm = 1000.0;
  Direction aim = Direction::from_unit({0.0, 0.0, -1.0});
  double tilt_x_deg = 0.0, tilt_y_deg = 0.0;
};

/// The frame of such a plane, z towards the luminaire. Throws InputError unless the distance is finite and
/// above 0.
Frame plane_frame(const PlanePlacement& placement);

/// Illuminance in lx (irradiance in W/m2 for radiometric data) at a point of the luminaire frame, on a
/// surface with the normal: I cos / r^2. 0 if the light meets the back. The luminaire counts as a point: for
/// an even disc that is 1 % too much at five times its diameter and falls with the square of the distance.
/// The point must not be the origin (InputError). O(log values).
double illuminance_lx(const IntensityDistribution& distribution, const Vec3& point_mm,
                      const Direction& normal);

/// The part of a plane that has at least a share of the largest illuminance, between cell centres linear.
struct LitArea {
  double fraction = 0.5;
  double area_mm2 = 0.0;
  double diameter_mm = 0.0;                   ///< of the circle of that area
  double width_x_mm = 0.0, width_y_mm = 0.0;  ///< extent along x and y
  bool cut = false;  ///< the area reaches the outermost cells: it goes on beyond, all sizes are lower bounds
};

/// Illuminance on a plane and the figures quoted of it.
struct PlaneIlluminance {
  IlluminatedPlane plane;
  std::vector<double> lx;  ///< cell (ix, iy) at iy * nx + ix; W/m2 if the distribution is radiometric
  double centre_lx = 0.0;  ///< at the rectangle's centre itself
  double mean_lx = 0.0, min_lx = 0.0, max_lx = 0.0;
  double max_x_mm = 0.0, max_y_mm = 0.0;  ///< of the brightest cell (the first among equals)
  double uniformity = 0.0;                ///< U0 = min / mean; 0 in the dark
  LitArea half, tenth;                    ///< at 50 % and 10 % of the maximum

  /// Flux onto the rectangle, lm or W.
  double flux() const { return mean_lx * plane.size_x_mm * plane.size_y_mm * 1e-6; }
};

/// Computes all of it. Throws InputError if the distribution's grid breaks its rules, a size is not above
/// 0, there are less than 2 x 2 or more than 16 M cells, or a cell's centre is the luminaire's. Parallel;
/// the same for any number of threads. O(cells log values).
PlaneIlluminance plane_illuminance(const IntensityDistribution& distribution, const IlluminatedPlane& plane);

/// The part of a plane with at least `fraction` of `max_lx`. `fraction` in (0, 1]. O(cells).
LitArea lit_area(const PlaneIlluminance& illuminance, double fraction);

}  // namespace lucerna
