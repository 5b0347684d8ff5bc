// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "lucerna/detectors.h"

namespace lucerna {

/// Finds the cells of a plane or luminance detector.
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
  /// Plane: what falls on its lit side. Cone: within min_cosine_ of +z. Pupil: through a disk at
  /// distance_mm_.
  enum class Kind { plane, cone, pupil } kind_;
  double min_cosine_ = 0.0, distance_mm_ = 0.0, pupil_radius_mm_ = 0.0;
};

LUCERNA_HD inline bool PlaneBins::counts(const Ray& r, double t) const {
  if (kind_ == Kind::plane) return r.direction.z() < 0.0 && t >= 0.0;
  if (kind_ == Kind::cone) return r.direction.z() >= min_cosine_;
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
