// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <string>

#include "lucerna/geometry.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// A far-field detector: all light that leaves, by direction, on a CIE Type C grid in the luminaire frame.
struct FarFieldDetector {
  /// The stem of the files that are written of it.
  std::string name = "far-field";
  /// Must divide 360 and 180 evenly.
  double c_step_deg = 5.0;
  /// Likewise, along gamma.
  double gamma_step_deg = 1.0;
  /// A ray counts for its four neighbours in proportion to nearness, not for the nearest alone: smooth curves
  /// from few rays, edges a step wider.
  bool tent = false;
  friend bool operator==(const FarFieldDetector&, const FarFieldDetector&) = default;
};

/// An even grid of nx x ny cells on a rectangle about the origin of a frame, in its xy plane.
struct PlaneGrid {
  /// Where the grid is.
  Frame world_from_plane;
  /// Size of the rectangle; > 0.
  double size_x_mm = 1000.0, size_y_mm = 1000.0;
  /// Cells along x and y; nx * ny at most 16 M.
  std::size_t nx = 100, ny = 100;

  /// Number of cells.
  std::size_t size() const { return nx * ny; }
  /// Centre of a cell along x, in the plane's frame.
  double cell_x_mm(std::size_t cell) const {
    return (static_cast<double>(cell % nx) + 0.5) * size_x_mm / static_cast<double>(nx) - 0.5 * size_x_mm;
  }
  /// Centre of a cell along y, in the plane's frame.
  double cell_y_mm(std::size_t cell) const {
    const std::size_t row = cell / nx;
    return (static_cast<double>(row) + 0.5) * size_y_mm / static_cast<double>(ny) - 0.5 * size_y_mm;
  }
  /// Area of a cell, mm^2.
  double cell_mm2() const {
    return size_x_mm / static_cast<double>(nx) * size_y_mm / static_cast<double>(ny);
  }
  friend bool operator==(const PlaneGrid&, const PlaneGrid&) = default;
};

/// Illuminance on a plane: counts light that has left the luminaire and falls on the side that the frame's +z
/// points to. It does not block light. Cells are numbered iy * nx + ix, both from the negative side.
struct PlaneDetector {
  /// The stem of the files that are written of it.
  std::string name = "plane";
  /// Where it is, and its cells.
  PlaneGrid grid;
  friend bool operator==(const PlaneDetector&, const PlaneDetector&) = default;
};

/// The luminaire as it looks: luminance by place on a plane across the direction of view. The frame's +z
/// points from the luminaire to the observer. From afar (`distance_mm` = 0) light within `half_angle_deg` of
/// it counts; an observer at `distance_mm` in front of the plane's middle sees what passes a pupil about that
/// point, parallel to the plane. Either way a ray counts where its line crosses the plane, so a narrow cone
/// or pupil is sharper and noisier.
struct LuminanceDetector {
  /// The stem of the files that are written of it.
  std::string name = "luminance";
  /// Where it is, and its cells.
  PlaneGrid grid;
  /// Half angle of the cone of directions that count, from afar.
  double half_angle_deg = 2.0;
  /// Of the observer from the plane; 0 = from afar.
  double distance_mm = 0.0;
  /// Of the near observer.
  double pupil_radius_mm = 1.0;
  friend bool operator==(const LuminanceDetector&, const LuminanceDetector&) = default;
};

/// A frame for a grid that faces along `normal`: its y axis is `up` as it is seen from there, so that x runs
/// to the right for who looks at the lit side. `up` parallel to `normal`: +y takes its place.
[[nodiscard]] Frame facing_frame(const Direction& normal, const Vec3& up, const Vec3& position_mm);

/// Throws InputError on a size that is not above 0, no cells or more than 16 M.
void check(const PlaneDetector& detector);
/// The same, and on an angle outside (0, 90), a distance below 0 or a pupil that is not above 0.
void check(const LuminanceDetector& detector);

/// What light of luminance 1 carries into a cell, mm^2 sr. From afar: cell area times pi sin^2 of the cone;
/// else the integral of D^2 / r^4 over cell and pupil (parallel at distance D), by rules that are exact to
/// the third order of both sizes over D.
double etendue_mm2sr(const LuminanceDetector& detector, std::size_t cell);

/// All rays that leave, as a file: a traced luminaire as a new source.
struct RayDetector {
  /// The stem of the file that is written.
  std::string name = "rays";
  /// One of `ray_formats()`.
  std::string format = "tm25";
  friend bool operator==(const RayDetector&, const RayDetector&) = default;
};

/// Throws InputError on an unknown format.
void check(const RayDetector& detector);

}  // namespace lucerna
#pragma GCC visibility pop
