// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/faced_body.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "lucerna/optics/shapes/faced_outline.h"
#include "lucerna/trace/engines/solid_rays.h"

namespace lucerna {

namespace {

/// A wall and its face overlap by so much at the rim, over the radius: no ray slips through between them.
constexpr double kOverlap = 1e-10;
/// Cells of the face's quadtree, 2^this a side.
constexpr int kLevels = 7;

HeightRange band_of(const HeightSurface& face, double radius_mm) {
  return face.range({-radius_mm, radius_mm, -radius_mm, radius_mm});
}

double highest_mm(const HeightSurface& face, double radius_mm) { return band_of(face, radius_mm).high_mm; }

/// The sides of base and walls, which go on as high as any of their faces: the inner wall first, where there
/// is a bottom face, and the outer wall last.
std::vector<OutlineSide> closed_sides(std::span<const OutlinePoint> corners_mm, const BodyFaces& faces,
                                      double smooth_below_deg, double tolerance_mm) {
  std::vector<OutlineSide> out = faced_base_sides(corners_mm, smooth_below_deg, tolerance_mm);
  const OutlinePoint& low = corners_mm[corners_mm.size() - 2];
  out.push_back(
      {low, {low[0], highest_mm(faces.top, low[0])}, {1.0, 0.0}, {1.0, 0.0}, corners_mm.size() - 2});
  if (faces.bottom) {
    const OutlinePoint& foot = corners_mm[1];
    out.insert(out.begin(),
               {{foot[0], highest_mm(*faces.bottom, foot[0])}, foot, {-1.0, 0.0}, {-1.0, 0.0}, 0});
  }
  return out;
}

Reflector face_within(std::shared_ptr<const HeightSurface> face, double radius_mm) {
  return {std::move(face), Aperture::circle(2.0 * (1.0 + kOverlap) * radius_mm)};
}

}  // namespace

FacedBody::Face::Face(std::shared_ptr<const HeightSurface> height_field, double radius_mm, double up_side,
                      std::int32_t wall_part, std::int32_t face_part)
    : height(std::move(height_field)),
      tracer(face_within(height, radius_mm), kLevels),
      band(band_of(*height, (1.0 + kOverlap) * radius_mm)),
      up(up_side),
      wall(wall_part),
      part(face_part) {}

Vec3 FacedBody::Face::normal(const Vec3& point_mm) const {
  const SurfacePoint at = height->at(point_mm.x, point_mm.y);
  return up * Vec3{-at.dzdx, -at.dzdy, 1.0};
}

bool FacedBody::Face::is_below(const Vec3& p) const {
  return p.z <= height->at(p.x, p.y).z_mm + kOverlap * (p.x * p.x + p.y * p.y);
}

FacedBody::FacedBody(std::span<const OutlinePoint> corners_mm,
                     const std::shared_ptr<const HeightSurface>& top,
                     const std::shared_ptr<const HeightSurface>& bottom, double smooth_below_deg,
                     double tolerance_mm)
    : FacedBody(closed_sides(corners_mm, {*top, bottom.get()}, smooth_below_deg, tolerance_mm), corners_mm,
                top, bottom) {}

FacedBody::FacedBody(const std::vector<OutlineSide>& sides, std::span<const OutlinePoint> corners_mm,
                     const std::shared_ptr<const HeightSurface>& top,
                     const std::shared_ptr<const HeightSurface>& bottom)
    : below_(sides) {
  for (const OutlineSide& s : sides) corners_.push_back(s.corner);
  const auto add = [&](const std::shared_ptr<const HeightSurface>& face, double radius_mm, double up,
                       std::size_t wall, std::size_t corner) {
    faces_.emplace_back(face, radius_mm, up, static_cast<std::int32_t>(wall),
                        static_cast<std::int32_t>(corners_.size()));
    corners_.push_back(corner);
  };
  add(top, corners_mm.back()[0], 1.0, sides.size() - 1, corners_mm.size() - 1);
  if (bottom) add(bottom, corners_mm.front()[0], -1.0, 0, corners_mm.size() + 1);
}

SurfaceHit FacedBody::first_below(const Ray& ray, double t_min_mm, double t_max_mm) const {
  const RevolvedSurface surface{below_.view()};
  for (;;) {
    const SurfaceHit hit = surface.first(ray, t_min_mm, t_max_mm);
    const auto of_wall = [&](const Face& f) { return f.wall == hit.part; };
    const auto face = std::find_if(faces_.begin(), faces_.end(), of_wall);
    if (face == faces_.end() || face->is_below(ray.at(hit.t_mm))) return hit;
    t_min_mm = hit.t_mm + kSolidStart;
  }
}

SurfaceHit FacedBody::first(const Ray& ray, double t_min_mm, double t_max_mm) const {
  SurfaceHit hit = first_below(ray, t_min_mm, t_max_mm);
  for (const Face& face : faces_) {
    const auto face_mm = face.tracer.first_mm({ray.at(t_min_mm), ray.direction});
    if (!face_mm) continue;
    const double t_mm = t_min_mm + *face_mm;
    if (t_mm < (hit.part < 0 ? t_max_mm : hit.t_mm)) hit = {face.part, t_mm, 0.0, 0.0};
  }
  return hit;
}

void FacedBody::first(const SolidKernels& kernels, double t_min_mm, std::size_t n, SolidBatch& batch) const {
  double t_max_mm[kSolidBatch];
  std::copy_n(batch.t, n, t_max_mm);
  kernels.first_sides(below_.blocks(), t_min_mm, n, batch);
  std::fill_n(batch.v, n, 0.0);
  for (const Face& face : faces_) face.meet(t_min_mm, n, batch);
  for (std::size_t i = 0; i < n; ++i) {
    const Ray ray = ray_of(batch, i);
    const auto passes_above = [&](const Face& face) {
      return face.wall == batch.part[i] && !face.is_below(ray.at(batch.t[i]));
    };
    if (!std::ranges::any_of(faces_, passes_above)) continue;
    const SurfaceHit hit = first(ray, t_min_mm, t_max_mm[i]);
    batch.part[i] = hit.part;
    batch.t[i] = hit.part < 0 ? t_max_mm[i] : hit.t_mm;
    batch.u[i] = hit.u;
  }
}

void FacedBody::Face::meet(double t_min_mm, std::size_t n, SolidBatch& batch) const {
  HitRays rays;
  std::size_t number[kSolidBatch], count = 0;
  for (std::size_t i = 0; i < n; ++i) {
    // What does not come to its height before it meets something else does not meet it.
    const double from = batch.oz[i] + t_min_mm * batch.dz[i], to = batch.oz[i] + batch.t[i] * batch.dz[i];
    if (std::max(from, to) < band.low_mm || std::min(from, to) > band.high_mm) continue;
    const Vec3 start_mm = ray_of(batch, i).at(t_min_mm);
    rays.x[count] = start_mm.x, rays.y[count] = start_mm.y, rays.z[count] = start_mm.z;
    rays.dx[count] = batch.dx[i], rays.dy[count] = batch.dy[i], rays.dz[count] = batch.dz[i];
    rays.on_mirror[count] = rays.slope[count] = 0.0;
    number[count++] = i;
  }
  if (count == 0) return;
  double way_mm[kSolidBatch];
  tracer.first_mm(rays, count, way_mm);
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = number[k];
    const double t_mm = t_min_mm + way_mm[k];
    if (!(t_mm < batch.t[i])) continue;
    batch.part[i] = part;
    batch.t[i] = t_mm;
    batch.u[i] = 0.0;
  }
}

void FacedBody::normals(const SolidKernels& kernels, std::size_t n, SolidBatch& batch) const {
  std::int32_t part[kSolidBatch];
  std::copy_n(batch.part, n, part);
  // The kernel knows sides only: what is on a face is written over.
  for (std::size_t i = 0; i < n; ++i) batch.part[i] = face_of(part[i]) == nullptr ? part[i] : 0;
  kernels.side_normals(below_.view().sides, n, batch);
  std::copy_n(part, n, batch.part);
  for (std::size_t i = 0; i < n; ++i) {
    const Face* const face = face_of(part[i]);
    if (face == nullptr) continue;
    const Vec3 normal = face->normal(ray_of(batch, i).at(batch.t[i]));
    batch.nx[i] = batch.sx[i] = normal.x;
    batch.ny[i] = batch.sy[i] = normal.y;
    batch.nz[i] = batch.sz[i] = normal.z;
  }
}

const FacedBody::Face* FacedBody::face_of(std::int32_t part) const {
  for (const Face& face : faces_) {
    if (face.part == part) return &face;
  }
  return nullptr;
}

Vec3 FacedBody::outward(const Vec3& point_mm, const SurfaceHit& hit) const {
  if (const Face* face = face_of(hit.part)) return face->normal(point_mm);
  return RevolvedSurface{below_.view()}.outward(point_mm, hit);
}

Vec3 FacedBody::smooth(const Vec3& point_mm, const SurfaceHit& hit) const {
  if (const Face* face = face_of(hit.part)) return face->normal(point_mm);
  return RevolvedSurface{below_.view()}.smooth(point_mm, hit);
}

}  // namespace lucerna
