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
  /// Middle of a cell in the plane's frame.
  double cell_x_mm(std::size_t cell) const {
    return (static_cast<double>(cell % nx) + 0.5) * size_x_mm / static_cast<double>(nx) - 0.5 * size_x_mm;
  }
  double cell_y_mm(std::size_t cell) const {
    const std::size_t row = cell / nx;
    return (static_cast<double>(row) + 0.5) * size_y_mm / static_cast<double>(ny) - 0.5 * size_y_mm;
  }
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

/// The luminaire as it looks: luminance by place on a plane across the direction of view. The frame's +z
/// points from the luminaire to the observer. From afar (`distance_mm` = 0) light within `half_angle_deg` of
/// it counts; an observer at `distance_mm` in front of the plane's middle sees what passes a pupil about that
/// point, parallel to the plane. Either way a ray counts where its line crosses the plane, so a narrow cone
/// or pupil is sharper and noisier.
struct LuminanceDetector {
  std::string name = "luminance";
  PlaneGrid grid;
  double half_angle_deg = 2.0;
  double distance_mm = 0.0;
  double pupil_radius_mm = 1.0;
  friend bool operator==(const LuminanceDetector&, const LuminanceDetector&) = default;
};

/// A frame for a grid that faces along `normal`: its y axis is `up` as it is seen from there, so that x runs
/// to the right for who looks at the lit side. `up` parallel to `normal`: +y takes its place.
Frame facing_frame(const Direction& normal, const Vec3& up, const Vec3& position_mm);

/// Throw InputError on a size that is not above 0, no cells or more than 16 M, an angle outside (0, 90), a
/// pupil or distance that is not above 0, a name that is no file name.
void check(const PlaneDetector& detector);
void check(const LuminanceDetector& detector);

/// What light of luminance 1 carries into a cell, mm^2 sr. From afar: cell area times pi sin^2 of the cone;
/// else the integral of D^2 / r^4 over cell and pupil (parallel at distance D), by rules that are exact to
/// the third order of both sizes over D.
double etendue_mm2sr(const LuminanceDetector& detector, std::size_t cell);

/// Finds the cells of either.
class PlaneBins {
 public:
  explicit PlaneBins(const PlaneDetector& detector);
  explicit PlaneBins(const LuminanceDetector& detector);

  std::size_t size() const { return grid_.size(); }
  /// The cell that a ray's last leg falls into, if it does.
  LUCERNA_HD std::optional<std::size_t> cell(const Ray& ray) const;

 private:
  /// Does a ray in the plane's frame count? It crosses the plane at distance t.
  LUCERNA_HD bool counts(const Ray& r, double t) const;

  PlaneGrid grid_;
  Frame plane_from_world_;
  /// Plane: what falls on its lit side. Cone: within least_cosine_ of +z. Pupil: through a disk at
  /// distance_mm_.
  enum class Kind { plane, cone, pupil } kind_;
  double least_cosine_ = 0.0, distance_mm_ = 0.0, pupil_radius_mm_ = 0.0;
};

/// All rays that leave, as a file: a traced luminaire as a new source.
struct RayDetector {
  std::string name = "rays";
  /// One of `ray_formats()`.
  std::string format = "tm25";
  friend bool operator==(const RayDetector&, const RayDetector&) = default;
};

/// Throws InputError on an unknown format.
void check(const RayDetector& detector);

LUCERNA_HD inline bool PlaneBins::counts(const Ray& r, double t) const {
  if (kind_ == Kind::plane) return r.direction.z() < 0.0 && t >= 0.0;
  if (kind_ == Kind::cone) return r.direction.z() >= least_cosine_;
  if (!(r.direction.z() > 0.0)) return false;
  const double at_pupil = t + distance_mm_ / r.direction.z();
  const Vec3 p = r.at(at_pupil);
  return at_pupil >= 0.0 && p.x * p.x + p.y * p.y <= pupil_radius_mm_ * pupil_radius_mm_;
}

LUCERNA_HD inline std::optional<std::size_t> PlaneBins::cell(const Ray& ray) const {
  const Ray r = plane_from_world_.ray(ray);
  const double t = -r.origin_mm.z / r.direction.z();
  if (!counts(r, t)) return std::nullopt;
  const Vec3 p = r.at(t);
  const double u = (p.x / grid_.size_x_mm + 0.5) * static_cast<double>(grid_.nx);
  const double v = (p.y / grid_.size_y_mm + 0.5) * static_cast<double>(grid_.ny);
  if (!(u >= 0.0 && v >= 0.0 && u < static_cast<double>(grid_.nx) && v < static_cast<double>(grid_.ny))) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(v) * grid_.nx + static_cast<std::size_t>(u);
}

}  // namespace lucerna
