// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/scene.h"
#include "lucerna/trace/kernels/scatter_kernel.h"
#include "lucerna/trace/kernels/triangle_kernel.h"

namespace lucerna {

// What light does at bodies of triangles; small functions that CPU and GPU share.

struct BodyHit {
  double t_mm = 0.0;
  std::size_t body = 0;
  /// Normal towards the side the ray came from: the triangle's own, or the smooth one where that sends the
  /// reflected ray to the same side.
  Direction normal;
  /// The triangle's own, towards the same side.
  Direction face;
};

/// A start that lies on a triangle is stepped over by this much, mm, once the ray was reflected.
inline constexpr double kBodyStart = 1e-3;

/// A hit with a surface of `normal` (any length, either side) whose smooth normal is `blend` (likewise); 0
/// for none.
LUCERNA_HD inline BodyHit smoothed_hit(const Direction& direction, double t_mm, std::size_t body,
                                       const Vec3& normal, const Vec3& blend) {
  Direction n = Direction::from(normal);
  if (dot(n, direction) > 0.0) n = -n;
  BodyHit hit{t_mm, body, n, n};
  if (!(length(blend) > 0.0)) return hit;
  Direction smooth = Direction::from(blend);
  if (dot(smooth, n) < 0.0) smooth = -smooth;
  const bool same_side = dot(smooth, direction) < 0.0 && dot(reflect(direction, smooth), n) > 0.0;
  if (same_side) hit.normal = smooth;
  return hit;
}

/// The smooth normal within a triangle, of any length. `corners`: its three, or null; u and v are the weights
/// of the second and third.
LUCERNA_HD inline Vec3 blended_normal(const Vec3* corners, double u, double v) {
  if (corners == nullptr) return {};
  return (1.0 - u - v) * corners[0] + u * corners[1] + v * corners[2];
}

/// A hit with a triangle of `normal` (any length, either side); `corners`, u and v as blended_normal takes
/// them.
LUCERNA_HD inline BodyHit body_hit(const Direction& direction, double t_mm, std::size_t body,
                                   const Vec3& normal, const Vec3* corners, double u, double v) {
  return smoothed_hit(direction, t_mm, body, normal, blended_normal(corners, u, v));
}

/// Where a mirror sends a ray that met it: about the normal, tilted by its slope error of this reflection,
/// and on by its lobes. What of this leads into the triangle is reflected there once more: nothing leaks
/// through.
LUCERNA_HD inline Direction reflected_off(const SurfaceFinish& finish, const Direction& direction,
                                          const BodyHit& hit, const ReflectionKey& key) {
  const bool tilts = finish.slope_error_rad > 0.0;
  const Direction normal = tilts ? tilted_normal(hit.normal, finish.slope_error_rad, key) : hit.normal;
  Direction out = Direction::from(reflect(direction, normal));
  if (finish.scatters()) out = scattered(finish, normal, out, key);
  return (tilts || finish.scatters()) && dot(out, hit.face) < 0.0 ? Direction::from(reflect(out, hit.face))
                                                                  : out;
}

/// A body as a kernel reads it.
struct BodyView {
  const ReflectanceEntry* reflectance = nullptr;
  std::uint32_t reflectance_entries = 0;
  SurfaceFinish finish;
  /// Three a triangle, in the luminaire frame; null for flat triangles.
  const Vec3* corner_normals = nullptr;
};

/// All bodies of a scene: what light straight from the source meets, and what all other light does.
struct BodiesView {
  TriangleBvhView direct, returning;
  const BodyView* bodies = nullptr;
  std::size_t count = 0;
};

/// As BodyTracer::first_hit.
LUCERNA_HD inline std::optional<BodyHit> first_body(const BodiesView& v, const Ray& ray, double t_max_mm,
                                                    bool returning) {
  const TriangleBvhView& tree = returning ? v.returning : v.direct;
  const TriangleHit hit =
      first_triangle(tree, ray.origin_mm, ray.direction.vec(), returning ? kBodyStart : 0.0, t_max_mm);
  if (hit.triangle < 0) return std::nullopt;
  const TreeTriangle& k = tree.triangles[hit.triangle];
  const Vec3* const corners = v.bodies[k.body].corner_normals;
  return body_hit(ray.direction, hit.t, k.body, normal_of(k),
                  corners == nullptr ? nullptr : corners + std::size_t{3} * k.number, hit.u, hit.v);
}

}  // namespace lucerna
