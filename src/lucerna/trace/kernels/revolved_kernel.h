// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/trace/kernels/revolved_view.h"

namespace lucerna {

// The first hit of a ray with a surface of revolution about z, made of cones, one ray at a time, in double;
// small functions that CPU and GPU share.

struct SideHit {
  std::int32_t side = -1;  ///< none
  double t = 0.0;
  double share = 0.0;  ///< of the way along the side, 0 to 1
};

/// A ray as rings and cones are tested with it: r^2 along it is (a t + 2 b) t + c.
struct RevolvedRay {
  Vec3 o, d;
  double inverse_dz, a, b, c, nearest, spin;

  LUCERNA_HD RevolvedRay(const Vec3& origin_mm, const Vec3& direction) : o(origin_mm), d(direction) {
    inverse_dz = 1.0 / (std::fabs(d.z) < 1e-30 ? std::copysign(1e-30, d.z) : d.z);
    a = d.x * d.x + d.y * d.y;
    b = o.x * d.x + o.y * d.y;
    c = o.x * o.x + o.y * o.y;
    nearest = a > 0.0 ? -b / a : 0.0;
    spin = o.x * d.y - o.y * d.x;
  }

  LUCERNA_HD double r2(double t) const { return (a * t + 2.0 * b) * t + c; }

  /// True if the ray is surely not in the ring within [t_min, t_max].
  LUCERNA_HD bool misses(const RevolvedNode& n, double t_min, double t_max) const {
    const double p = (n.z_low - o.z) * inverse_dz, q = (n.z_high - o.z) * inverse_dz;
    const double in = p < q ? p : q, out = p < q ? q : p;
    const double from = in > t_min ? in : t_min, to = out < t_max ? out : t_max;
    if (from > to) return true;
    const double at = nearest < from ? from : nearest > to ? to : nearest;
    if (r2(at) > n.r2_high) return true;
    return r2(from) < n.r2_low && r2(to) < n.r2_low;
  }
};

/// Moves `best` to the side if the ray meets it at `t` in (t_min, best.t). w - g t is nr r along the ray's
/// way on the cone; the other sign is its mirror image beyond the apex.
LUCERNA_HD inline void meet_side_at(const RevolvedSide& k, std::int32_t i, const RevolvedRay& ray, double t,
                                    double w, double g, double t_min, SideHit& best) {
  if (!(t > t_min && t < best.t) || k.nr * (w - g * t) < 0.0) return;
  const double x = ray.o.x + t * ray.d.x, y = ray.o.y + t * ray.d.y, z = ray.o.z + t * ray.d.z;
  const double share = (std::sqrt(x * x + y * y) - k.r) * k.along_r + (z - k.z) * k.along_z;
  if (share < -kSideBorder || share > 1.0 + kSideBorder) return;
  best = {i, t, share};
}

/// Moves `best` to side number `i` if the ray meets it in (t_min, best.t). The square of nr r = w - g t is a
/// quadratic in t, whose discriminant is nr^2 times `spread`: a flat side has one root without loss of
/// digits.
LUCERNA_HD inline void intersect_side(const RevolvedSide& k, std::int32_t i, const RevolvedRay& ray,
                                      double t_min, SideHit& best) {
  const double w = k.offset - k.nz * ray.o.z, g = k.nz * ray.d.z;
  const double vx = w * ray.d.x + g * ray.o.x, vy = w * ray.d.y + g * ray.o.y;
  const double spread = vx * vx + vy * vy - (k.nr * k.nr) * (ray.spin * ray.spin);
  if (!(spread >= 0.0)) return;
  const double root = std::fabs(k.nr) * std::sqrt(spread);
  const double a = k.nr * k.nr * ray.a - g * g, b = k.nr * k.nr * ray.b + g * w,
               c = k.nr * k.nr * ray.c - w * w;
  const double q = b < 0.0 ? -b + root : -b - root;
  meet_side_at(k, i, ray, q / a, w, g, t_min, best);
  meet_side_at(k, i, ray, c / q, w, g, t_min, best);
}

/// The first side in (t_min, t_max). `direction` is unit.
LUCERNA_HD inline SideHit first_side(const RevolvedView& view, const Vec3& origin_mm, const Vec3& direction,
                                     double t_min, double t_max) {
  SideHit best;
  best.t = t_max;
  const RevolvedRay ray(origin_mm, direction);
  for (std::int32_t i = 0; i < view.node_count;) {
    const RevolvedNode& node = view.nodes[i];
    if (ray.misses(node, t_min, best.t)) {
      i = node.skip;
      continue;
    }
    if (node.side >= 0) intersect_side(view.sides[node.side], node.side, ray, t_min, best);
    ++i;
  }
  return best;
}

/// Unit vector of a normal (nr, nz) in the half plane of a point; on the axis, that of +x.
LUCERNA_HD inline Vec3 turned_normal(double nr, double nz, const Vec3& point) {
  const double r = std::sqrt(point.x * point.x + point.y * point.y);
  if (!(r > 0.0)) return {nr, 0.0, nz};
  return {nr * point.x / r, nr * point.y / r, nz};
}

/// Outward, unit: the cone's own.
LUCERNA_HD inline Vec3 cone_normal(const RevolvedSide& k, const Vec3& point) {
  return turned_normal(k.nr, k.nz, point);
}

/// Outward, nearly unit: that of the curve that the side stands for.
LUCERNA_HD inline Vec3 curve_normal(const RevolvedSide& k, double share, const Vec3& point) {
  return turned_normal(k.from_nr + share * (k.to_nr - k.from_nr), k.from_nz + share * (k.to_nz - k.from_nz),
                       point);
}

}  // namespace lucerna
