// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/detectors/plane_bins.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/ray_file.h"

namespace lucerna {

namespace {

void check_grid(const std::string& name, const PlaneGrid& grid) {
  constexpr std::size_t kMaxPlaneCells = std::size_t{1} << 24;
  for (const double size : {grid.size_x_mm, grid.size_y_mm}) {
    if (!(size > 0.0 && std::isfinite(size))) {
      throw InputError(
          fmt::format("detector '{}': a size of {} mm, expected a finite number above 0", name, size));
    }
  }
  if (grid.nx == 0 || grid.ny == 0 || grid.nx > kMaxPlaneCells / grid.ny) {
    throw InputError(fmt::format("detector '{}': {} x {} cells, expected 1 to {}", name, grid.nx, grid.ny,
                                 kMaxPlaneCells));
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
  if (!(detector.distance_mm >= 0.0 && std::isfinite(detector.distance_mm) &&
        detector.pupil_radius_mm > 0.0 && std::isfinite(detector.pupil_radius_mm))) {
    throw InputError(fmt::format("detector '{}': a pupil of radius {} mm at {} mm, expected finite numbers",
                                 detector.name, detector.pupil_radius_mm, detector.distance_mm));
  }
}

void check(const RayDetector& detector) {
  const auto formats = ray_formats();
  if (std::find(formats.begin(), formats.end(), detector.format) != formats.end()) return;
  throw InputError(fmt::format("detector '{}': unknown ray format '{}', expected one of {}", detector.name,
                               detector.format, fmt::join(formats, " ")));
}

Frame facing_frame(const Direction& normal, const Vec3& up, const Vec3& position_mm) {
  const auto across = [&](const Vec3& v) { return v - dot(v, normal.vec()) * normal.vec(); };
  Vec3 y = across(up);
  if (length(y) < 1e-6 * length(up)) y = across({0.0, 1.0, 0.0});
  if (length(y) < 1e-6) y = across({1.0, 0.0, 0.0});
  const Vec3 ey = Direction::from(y).vec();
  return {cross(ey, normal.vec()), ey, normal.vec(), position_mm};
}

namespace {

double afar_etendue_mm2sr(const LuminanceDetector& d) {
  const double sine = std::sin(radians(d.half_angle_deg));
  return d.grid.cell_mm2() * std::numbers::pi * sine * sine;
}

}  // namespace

double etendue_mm2sr(const LuminanceDetector& d, std::size_t cell) {
  if (d.distance_mm == 0.0) return afar_etendue_mm2sr(d);
  const double w = d.grid.size_x_mm / static_cast<double>(d.grid.nx),
               h = d.grid.size_y_mm / static_cast<double>(d.grid.ny);
  const double x = d.grid.cell_x_mm(cell), y = d.grid.cell_y_mm(cell);
  const double gauss = 0.5 / std::sqrt(3.0), ring = d.pupil_radius_mm / std::sqrt(2.0);
  const double pupil[4][2] = {{ring, 0.0}, {-ring, 0.0}, {0.0, ring}, {0.0, -ring}};
  const double square[4][2] = {{-gauss, -gauss}, {gauss, -gauss}, {-gauss, gauss}, {gauss, gauss}};
  double sum = 0.0;
  for (const auto& p : pupil) {
    for (const auto& q : square) {
      const double dx = x + q[0] * w - p[0], dy = y + q[1] * h - p[1];
      const double r2 = dx * dx + dy * dy + d.distance_mm * d.distance_mm;
      sum += d.distance_mm * d.distance_mm / (r2 * r2);
    }
  }
  return sum / 16.0 * d.grid.cell_mm2() * std::numbers::pi * d.pupil_radius_mm * d.pupil_radius_mm;
}

PlaneBins::PlaneBins(const PlaneDetector& detector)
    : grid_(detector.grid), plane_from_world_(detector.grid.world_from_plane.inverse()), kind_(Kind::plane) {}

PlaneBins::PlaneBins(const LuminanceDetector& detector)
    : grid_(detector.grid),
      plane_from_world_(detector.grid.world_from_plane.inverse()),
      kind_(detector.distance_mm > 0.0 ? Kind::pupil : Kind::cone),
      min_cosine_(std::cos(radians(detector.half_angle_deg))),
      distance_mm_(detector.distance_mm),
      pupil_radius_mm_(detector.pupil_radius_mm) {}

}  // namespace lucerna
