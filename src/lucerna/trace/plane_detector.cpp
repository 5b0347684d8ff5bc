// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/plane_detector.h"

#include <cmath>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

void check_grid(const std::string& name, const PlaneGrid& grid) {
  constexpr std::size_t kMostCells = std::size_t{1} << 24;
  for (const double size : {grid.size_x_mm, grid.size_y_mm}) {
    if (!(size > 0.0 && std::isfinite(size))) {
      throw InputError(
          fmt::format("detector '{}': a size of {} mm, expected a finite number above 0", name, size));
    }
  }
  if (grid.nx == 0 || grid.ny == 0 || grid.nx > kMostCells / grid.ny) {
    throw InputError(
        fmt::format("detector '{}': {} x {} cells, expected 1 to {}", name, grid.nx, grid.ny, kMostCells));
  }
}

}  // namespace

void check(const PlaneDetector& detector) { check_grid(detector.name, detector.grid); }

void check(const LuminanceDetector& detector) {
  check_grid(detector.name, detector.grid);
  if (!(detector.half_angle_deg > 0.0 && detector.half_angle_deg < 90.0)) {
    throw InputError(fmt::format("detector '{}': half_angle_deg = {}, expected above 0 and below 90",
                                 detector.name, detector.half_angle_deg));
  }
}

PlaneBins::PlaneBins(const PlaneDetector& detector)
    : grid_(detector.grid),
      plane_from_world_(detector.grid.world_from_plane.inverse()),
      least_cosine_(-2.0) {}

PlaneBins::PlaneBins(const LuminanceDetector& detector)
    : grid_(detector.grid),
      plane_from_world_(detector.grid.world_from_plane.inverse()),
      least_cosine_(std::cos(radians(detector.half_angle_deg))) {}

std::optional<std::size_t> PlaneBins::cell(const Ray& ray) const {
  const Ray r = plane_from_world_.ray(ray);
  const double t = -r.origin_mm.z / r.direction.z();
  const bool falls_on =
      least_cosine_ < -1.0 ? r.direction.z() < 0.0 && t >= 0.0 : r.direction.z() >= least_cosine_;
  if (!falls_on) return std::nullopt;
  const Vec3 p = r.at(t);
  const double u = (p.x / grid_.size_x_mm + 0.5) * static_cast<double>(grid_.nx);
  const double v = (p.y / grid_.size_y_mm + 0.5) * static_cast<double>(grid_.ny);
  if (!(u >= 0.0 && v >= 0.0 && u < static_cast<double>(grid_.nx) && v < static_cast<double>(grid_.ny))) {
    return std::nullopt;
  }
  return static_cast<std::size_t>(v) * grid_.nx + static_cast<std::size_t>(u);
}

}  // namespace lucerna
