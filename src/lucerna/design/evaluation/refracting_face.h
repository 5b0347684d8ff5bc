// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lucerna/design/evaluation/smooth_path.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

// A free form as the last face of a lens: rays come down to it through the medium, and go on refracted.

/// What such a face does to a ray, kept for its derivative.
struct FaceHit {
  Vec3 d;             ///< where the ray came along
  Vec3 point;         ///< where it hit
  double t = 0.0;     ///< how far it came through the medium
  Vec3 g;             ///< (-h_x, -h_y, 1)
  double m = 0.0;     ///< d . g, negative
  double c = 1.0;     ///< cosine of incidence
  double turned = 0;  ///< what of the unit normal is added to the ray: d' = n d + turned N
  double turned_by_c = 0.0;
  /// Share that passes: not reflected, and not absorbed on the way.
  double share = 0.0;
  /// Derivatives of its logarithm by c and by the way.
  double log_by_c = 0.0, log_by_way = 0.0;
  Vec3 out;  ///< where it goes on along
  BsplineView::Local local;
};

/// A ray that meets the face after `t`. False where reflection is total.
inline bool refract_at(const BsplineView& shape, const MediumView& medium, const Vec3& o, const Vec3& d,
                       double t, FaceHit& hit) {
  hit.d = d;
  hit.t = t;
  hit.point = o + t * d;
  hit.local = shape.local(hit.point.x, hit.point.y);
  hit.g = {-hit.local.hx, -hit.local.hy, 1.0};
  hit.m = dot(d, hit.g);
  const double long_g = length(hit.g), ratio = 1.0 / medium.index;
  hit.c = std::fmin(1.0, -hit.m / long_g);
  const Boundary found = boundary(ratio, hit.c);
  const double cos_out = found.cos_refracted;
  if (!(cos_out > 0.0)) return false;
  hit.turned = medium.index * hit.c - cos_out;
  hit.turned_by_c = medium.index - medium.index * medium.index * hit.c / cos_out;
  hit.out = medium.index * d + (hit.turned / long_g) * hit.g;
  const double passes = 1.0 - found.reflectance();
  const AmplitudeSlopes slopes = amplitude_slopes(ratio, hit.c, cos_out);
  hit.share = passes * std::exp(-medium.absorption_per_mm * t);
  hit.log_by_c = passes > 1e-12 ? -(found.s * slopes.s + found.p * slopes.p) / passes : 0.0;
  hit.log_by_way = -medium.absorption_per_mm;
  return true;
}

/// Sensitivity of a figure of the leaving ray to a change of the face: `direction` and `point` are the
/// figure's gradients by where the ray goes on along and where it hit, `by_c` and `by_way` its own
/// derivatives by the cosine of incidence and by the way. The hit moves along its ray as the face rises, and
/// the normal turns with the slope there and with the place.
inline HitAdjoint face_adjoint(const FaceHit& hit, const Vec3& direction, const Vec3& point, double by_c,
                               double by_way) {
  const double long_g = length(hit.g);
  const Vec3 normal = hit.g / long_g;
  const double s = hit.turned_by_c * dot(direction, normal) + by_c;
  const Vec3 by_normal = hit.turned * direction - s * hit.d;
  const Vec3 by_g = (by_normal - dot(by_normal, normal) * normal) / long_g;
  const Vec3 bent{hit.local.hxx * hit.d.x + hit.local.hxy * hit.d.y,
                  hit.local.hxy * hit.d.x + hit.local.hyy * hit.d.y, 0.0};
  const double along = dot(point, hit.d) + by_way - by_g.x * bent.x - by_g.y * bent.y;
  return {along / hit.m, -by_g.x, -by_g.y};
}

}  // namespace lucerna
