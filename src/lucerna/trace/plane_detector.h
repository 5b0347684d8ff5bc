// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "lucerna/core/frame.h"

namespace lucerna {

/// An even grid of nx x ny cells on a rectangle about the origin of a frame, in its xy plane.
struct PlaneGrid {
  Frame world_from_plane;
  double size_x_mm = 1000.0, size_y_mm = 1000.0;
  std::size_t nx = 100, ny = 100;

  std::size_t size() const { return nx * ny; }
  double cell_mm2() const {
    return size_x_mm / static_cast<double>(nx) * size_y_mm / static_cast<double>(ny);
  }
  friend bool operator==(const PlaneGrid&, const PlaneGrid&) = default;
};

/// Illuminance on a plane: counts light that has left the luminaire and falls on the side that the frame's +z
/// points to. It does not block light. Cells are numbered iy * nx + ix, both from the negative side.
struct PlaneDetector {
  std::string name = "plane";
  PlaneGrid grid;
  friend bool operator==(const PlaneDetector&, const PlaneDetector&) = default;
};

/// The luminaire as it looks from afar: luminance by place on a plane across the direction of view. The
/// frame's +z points from the luminaire to the observer; light within `half_angle_deg` of it counts, where
/// its line crosses the plane, so a narrow cone is sharper and noisier.
struct LuminanceDetector {
  std::string name = "luminance";
  PlaneGrid grid;
  double half_angle_deg = 2.0;
  friend bool operator==(const LuminanceDetector&, const LuminanceDetector&) = default;
};

/// Throw InputError on a size that is not above 0, no cells or more than 16 M, an angle outside (0, 90).
void check(const PlaneDetector& detector);
void check(const LuminanceDetector& detector);

/// Finds the cells of either.
class PlaneBins {
 public:
  explicit PlaneBins(const PlaneDetector& detector);
  explicit PlaneBins(const LuminanceDetector& detector);

  std::size_t size() const { return grid_.size(); }
  /// The cell that a ray's last leg falls into, if it does.
  std::optional<std::size_t> cell(const Ray& ray) const;

 private:
  PlaneGrid grid_;
  Frame plane_from_world_;
  /// Least direction cosine to +z that counts; below -1 = a plane that counts what falls on it.
  double least_cosine_;
};

}  // namespace lucerna
