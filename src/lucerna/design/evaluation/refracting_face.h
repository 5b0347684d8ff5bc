// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lucerna/design/evaluation/smooth_path.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

// A free form as a face of a lens: rays come down to it and go on refracted. By the last face they leave the
// medium, by the first they come into it.

/// What is before a face and beyond it.
struct FaceMedia {
  /// Index before the face over that beyond it.
  double index = 1.0;
  /// Of the medium before it.
  double absorption_per_mm = 0.0;
};
inline FaceMedia media_of_last_face(const MediumView& medium) {
  return {medium.index, medium.absorption_per_mm};
}
inline FaceMedia media_of_first_face(const MediumView& medium) { return {1.0 / medium.index, 0.0}; }

/// What such a face does to a ray, kept for its derivative.
struct FaceHit {
  Vec3 d;              ///< where the ray came along
  Vec3 point;          ///< where it hit
  double t = 0.0;      ///< how far it came
  double index = 1.0;  ///< FaceMedia::index
  Vec3 g;              ///< (-h_x, -h_y, 1)
  double m = 0.0;      ///< d . g, negative
  double c = 1.0;      ///< cosine of incidence
  double turned = 0;   ///< what of the unit normal is added to the ray: d' = n d + turned N
  double turned_by_c = 0.0;
  /// Share that passes: not reflected, and not absorbed on the way.
  double share = 0.0;
  /// Derivatives of its logarithm by c and by the way.
  double log_by_c = 0.0, log_by_way = 0.0;
  Vec3 out;  ///< where it goes on along
  BsplineView::Local local;
};

/// A ray that meets the face after `t`. False where reflection is total.
inline bool refract_at(const BsplineView& shape, const FaceMedia& media, const Vec3& o, const Vec3& d,
                       double t, FaceHit& hit) {
  hit.d = d;
  hit.index = media.index;
  hit.t = t;
  hit.point = o + t * d;
  hit.local = shape.local(hit.point.x, hit.point.y);
  hit.g = {-hit.local.hx, -hit.local.hy, 1.0};
  hit.m = dot(d, hit.g);
  const double long_g = length(hit.g), ratio = 1.0 / media.index;
  hit.c = std::fmin(1.0, -hit.m / long_g);
  const Boundary found = boundary(ratio, hit.c);
  const double cos_out = found.cos_refracted;
  if (!(cos_out > 0.0)) return false;
  hit.turned = media.index * hit.c - cos_out;
  hit.turned_by_c = media.index - media.index * media.index * hit.c / cos_out;
  hit.out = media.index * d + (hit.turned / long_g) * hit.g;
  const double passes = 1.0 - found.reflectance();
  const AmplitudeSlopes slopes = amplitude_slopes(ratio, hit.c, cos_out);
  hit.share = passes * std::exp(-media.absorption_per_mm * t);
  hit.log_by_c = passes > 1e-12 ? -(found.s * slopes.s + found.p * slopes.p) / passes : 0.0;
  hit.log_by_way = -media.absorption_per_mm;
  return true;
}

/// Of a figure of the leaving ray, by a cosine of incidence and by the face's (-h_x, -h_y, 1).
struct FaceSlopes {
  double by_c;
  Vec3 normal, by_g;
};

/// `direction`: the figure's gradient by where the ray goes on along; `by_c`: its own by the cosine.
inline FaceSlopes face_slopes(const FaceHit& hit, const Vec3& direction, double by_c) {
  const double long_g = length(hit.g);
  const Vec3 normal = hit.g / long_g;
  const double s = hit.turned_by_c * dot(direction, normal) + by_c;
  const Vec3 by_normal = hit.turned * direction - s * hit.d;
  return {s, normal, (by_normal - dot(by_normal, normal) * normal) / long_g};
}

/// Sensitivity of a figure of the leaving ray to a change of the face: `direction` and `point` are the
/// figure's gradients by where the ray goes on along and where it hit, `by_c` and `by_way` its own
/// derivatives by the cosine of incidence and by the way. The hit moves along its ray as the face rises, and
/// the normal turns with the slope there and with the place.
inline HitAdjoint face_adjoint(const FaceHit& hit, const Vec3& direction, const Vec3& point, double by_c,
                               double by_way) {
  const Vec3 by_g = face_slopes(hit, direction, by_c).by_g;
  const Vec3 bent{hit.local.hxx * hit.d.x + hit.local.hxy * hit.d.y,
                  hit.local.hxy * hit.d.x + hit.local.hyy * hit.d.y, 0.0};
  const double along = dot(point, hit.d) + by_way - by_g.x * bent.x - by_g.y * bent.y;
  return {along / hit.m, -by_g.x, -by_g.y};
}

/// A figure's gradients by where a ray goes along and where it begins.
struct RayGradient {
  Vec3 direction, point;
};

/// The same figure's sensitivity to the ray that comes to a face which stays as it is.
inline RayGradient ray_adjoint(const FaceHit& hit, const Vec3& direction, const Vec3& point, double by_c,
                               double by_way) {
  const FaceSlopes by = face_slopes(hit, direction, by_c);
  const Vec3& g = by.by_g;
  const Vec3 by_place =
      point - Vec3{g.x * hit.local.hxx + g.y * hit.local.hxy, g.x * hit.local.hxy + g.y * hit.local.hyy, 0.0};
  // Places off the ray's own go on along it to the face.
  const Vec3 by_begin = by_place - ((dot(by_place, hit.d) + by_way) / hit.m) * hit.g;
  return {hit.index * direction - by.by_c * by.normal + hit.t * by_begin, by_begin};
}

}  // namespace lucerna
