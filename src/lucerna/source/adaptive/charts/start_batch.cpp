// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/simd/vector_clones.h"
#include "lucerna/source/adaptive/charts/local_batch.h"

namespace lucerna {

namespace {

/// Distances along the rays to their starts; `good` is >= 0 where they hold, the others are made one by one.
struct Distances {
  BatchColumn t, good;
};

LUCERNA_VECTOR_CLONES void to_sphere(const BoundingSurface& s, const RayBatch& r, Distances& to) {
  const Vec3 o = s.world_from_surface.origin_mm();
  const double radius2 = s.radius_mm * s.radius_mm;
  Distances d;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double x = r.x[i] - o.x, y = r.y[i] - o.y, z = r.z[i] - o.z;
    const double along = x * r.kx[i] + y * r.ky[i] + z * r.kz[i];
    const double qx = x - along * r.kx[i], qy = y - along * r.ky[i], qz = z - along * r.kz[i];
    const double rest = radius2 - (qx * qx + qy * qy + qz * qz);
    d.t[i] = std::sqrt(std::max(0.0, rest)) - along;
    d.good[i] = rest;
  }
  to = d;
}

LUCERNA_VECTOR_CLONES void to_plane(const BoundingSurface& s, const RayBatch& r, Distances& to) {
  constexpr double kFlat = 1e-3;
  const Frame f = s.world_from_surface;
  Distances d;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const LocalRay l = local_ray(f, r, i);
    d.t[i] = -l.oz / l.dz;
    d.good[i] = std::abs(l.dz) - kFlat;
  }
  to = d;
}

LUCERNA_VECTOR_CLONES void to_box(const BoundingSurface& s, const RayBatch& r, Distances& to) {
  const Frame f = s.world_from_surface;
  const Vec3 half = s.half_size_mm;
  Distances d;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const LocalRay l = local_ray(f, r, i);
    const double ix = 1.0 / l.dx, iy = 1.0 / l.dy, iz = 1.0 / l.dz;
    const double mx = -l.ox * ix, my = -l.oy * iy, mz = -l.oz * iz;
    const double wx = std::abs(half.x * ix), wy = std::abs(half.y * iy), wz = std::abs(half.z * iz);
    const double far = std::min(mx + wx, std::min(my + wy, mz + wz));
    const double near = std::max(mx - wx, std::max(my - wy, mz - wz));
    // Along a face the distances to it are infinite or have no value: those rays are made one by one.
    const double min = std::min(std::abs(l.dx), std::min(std::abs(l.dy), std::abs(l.dz)));
    d.t[i] = far;
    d.good[i] = min > 1e-12 ? far - near : -1.0;
  }
  to = d;
}

LUCERNA_VECTOR_CLONES void to_cylinder(const BoundingSurface& s, const RayBatch& r, Distances& to) {
  const Frame f = s.world_from_surface;
  const double half = s.half_size_mm.z, radius2 = s.radius_mm * s.radius_mm;
  Distances d;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const LocalRay l = local_ray(f, r, i);
    const double a = l.dx * l.dx + l.dy * l.dy, inverse = 1.0 / a,
                 along = (l.ox * l.dx + l.oy * l.dy) * inverse;
    const double qx = l.ox - along * l.dx, qy = l.oy - along * l.dy, rest = radius2 - (qx * qx + qy * qy);
    const double w = std::sqrt(std::max(0.0, rest) * inverse), iz = 1.0 / l.dz;
    const double mz = -l.oz * iz, wz = std::abs(half * iz);
    const double far = std::min(w - along, mz + wz), near = std::max(-along - w, mz - wz);
    const double min = std::min(a, std::abs(l.dz));
    d.t[i] = far;
    d.good[i] = min > 1e-12 && rest >= 0.0 ? far - near : -1.0;
  }
  to = d;
}

LUCERNA_VECTOR_CLONES void slide(const Distances& d, const RayBatch& r, RayBatch& to) {
  RayBatch rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double t = d.good[i] >= 0.0 ? d.t[i] : 0.0;
    rays.x[i] = r.x[i] + t * r.kx[i];
    rays.y[i] = r.y[i] + t * r.ky[i];
    rays.z[i] = r.z[i] + t * r.kz[i];
  }
  to.x = rays.x, to.y = rays.y, to.z = rays.z;
}

}  // namespace

void start_batch_on(const BoundingSurface& surface, std::size_t n, RayBatch& rays) {
  Distances d;
  switch (surface.kind) {
    case SurfaceKind::none:
      return;
    case SurfaceKind::sphere:
      to_sphere(surface, rays, d);
      break;
    case SurfaceKind::plane:
      to_plane(surface, rays, d);
      break;
    case SurfaceKind::box:
      to_box(surface, rays, d);
      break;
    case SurfaceKind::cylinder:
      to_cylinder(surface, rays, d);
      break;
  }
  slide(d, rays, rays);
  for (std::size_t i = 0; i < n; ++i) {
    if (!(d.good[i] >= 0.0)) rays.set(i, start_on(surface, rays.ray(i)));
  }
}

}  // namespace lucerna
