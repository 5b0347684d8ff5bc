// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/faced_body.h"

#include <cstdint>
#include <utility>

#include "lucerna/optics/shapes/faced_outline.h"

namespace lucerna {

namespace {

/// Wall and face overlap by so much at the rim, over the radius: no ray slips through between them.
constexpr double kOverlap = 1e-10;
/// Cells of the face's quadtree, 2^this a side.
constexpr int kLevels = 7;

/// The sides of base and wall, which goes on as high as any of the face.
std::vector<OutlineSide> closed_sides(std::span<const OutlinePoint> corners_mm, const HeightSurface& face,
                                      double smooth_below_deg, double tolerance_mm) {
  std::vector<OutlineSide> out = faced_base_sides(corners_mm, smooth_below_deg, tolerance_mm);
  const OutlinePoint& low = corners_mm[corners_mm.size() - 2];
  const double radius = low[0], top = face.range({-radius, radius, -radius, radius}).high_mm;
  out.push_back({low, {radius, top}, {1.0, 0.0}, {1.0, 0.0}, corners_mm.size() - 2});
  return out;
}

Reflector face_within(std::shared_ptr<const HeightSurface> face, double radius_mm) {
  return {std::move(face), Aperture::circle(2.0 * (1.0 + kOverlap) * radius_mm)};
}

}  // namespace

FacedBody::FacedBody(std::span<const OutlinePoint> corners_mm,
                     const std::shared_ptr<const HeightSurface>& face, double smooth_below_deg,
                     double tolerance_mm)
    : FacedBody(closed_sides(corners_mm, *face, smooth_below_deg, tolerance_mm), face, corners_mm.back()[0],
                corners_mm.size() - 1) {}

FacedBody::FacedBody(const std::vector<OutlineSide>& sides, std::shared_ptr<const HeightSurface> face,
                     double radius_mm, std::size_t last_corner)
    : face_(std::move(face)),
      below_(sides),
      wall_(static_cast<std::int32_t>(sides.size()) - 1),
      top_(wall_ + 1),
      face_tracer_(face_within(face_, radius_mm), kLevels) {
  for (const OutlineSide& s : sides) corners_.push_back(s.corner);
  corners_.push_back(last_corner);
}

SurfaceHit FacedBody::first_below(const Ray& ray, double t_min_mm, double t_max_mm) const {
  const RevolvedSurface surface{below_.view()};
  for (;;) {
    const SurfaceHit hit = surface.first(ray, t_min_mm, t_max_mm);
    if (hit.part != wall_) return hit;
    const Vec3 p = ray.at(hit.t_mm);
    if (p.z <= face_->at(p.x, p.y).z_mm + kOverlap * (p.x * p.x + p.y * p.y)) return hit;
    t_min_mm = hit.t_mm + kSolidStart;
  }
}

SurfaceHit FacedBody::first(const Ray& ray, double t_min_mm, double t_max_mm) const {
  const SurfaceHit below = first_below(ray, t_min_mm, t_max_mm);
  const auto face_mm = face_tracer_.first_mm({ray.at(t_min_mm), ray.direction});
  if (!face_mm) return below;
  const double t_mm = t_min_mm + *face_mm;
  if (t_mm >= (below.part < 0 ? t_max_mm : below.t_mm)) return below;
  return {top_, t_mm, 0.0, 0.0};
}

Vec3 FacedBody::face_normal(const Vec3& point_mm) const {
  const SurfacePoint at = face_->at(point_mm.x, point_mm.y);
  return {-at.dzdx, -at.dzdy, 1.0};
}

Vec3 FacedBody::outward(const Vec3& point_mm, const SurfaceHit& hit) const {
  if (hit.part == top_) return face_normal(point_mm);
  return RevolvedSurface{below_.view()}.outward(point_mm, hit);
}

Vec3 FacedBody::smooth(const Vec3& point_mm, const SurfaceHit& hit) const {
  if (hit.part == top_) return face_normal(point_mm);
  return RevolvedSurface{below_.view()}.smooth(point_mm, hit);
}

}  // namespace lucerna
