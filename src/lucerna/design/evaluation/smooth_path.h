// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/optics/shapes/smooth_view.h"
#include "lucerna/reflector.h"
#include "lucerna/trace/kernels/hit_table.h"

namespace lucerna {

/// How a ray's way through a single mirror ends.
enum class PathEnd { direct, reflected, back, lost };

/// Reflections that a path keeps; a ray with more is lost.
inline constexpr int kMaxPathHits = 24;

/// The way of one ray, kept for its derivative.
template <class Shape>
struct Path {
  struct Hit {
    Vec3 d;       ///< where the ray came along
    double t;     ///< how far it came
    double x, y;  ///< where on the mirror
    Vec3 g;       ///< (-h_x, -h_y, 1)
    double m;     ///< d . g, negative on the face
    typename Shape::Local local;
  };
  PathEnd end = PathEnd::direct;
  int hits = 0;
  std::array<Hit, kMaxPathHits> hit;
  /// Where the ray leaves from, the last hit or its start, and along what.
  Vec3 origin, direction;
};

/// Where a ray goes on after meeting the mirror, and what it hit.
template <class Shape>
LUCERNA_HD void reflect_path(const Shape& shape, double t, Vec3& o, Vec3& d, typename Path<Shape>::Hit& hit) {
  const double x = o.x + t * d.x, y = o.y + t * d.y;
  hit.local = shape.local(x, y);
  hit.d = d;
  hit.x = x;
  hit.y = y;
  hit.t = t;
  hit.g = {-hit.local.hx, -hit.local.hy, 1.0};
  hit.m = dot(d, hit.g);
  o = {x, y, o.z + t * d.z};
  d = d - (2.0 * hit.m / dot(hit.g, hit.g)) * hit.g;
}

/// Traces rays through one mirror (Shape: a view of smooth_view.h) z = r^2 / (4 f) + s(x, y) over an
/// aperture, all in the mirror's frame, one at a time. Immutable, thread safe.
template <class Shape>
class SmoothTracer {
 public:
  LUCERNA_HD SmoothTracer(const Shape& shape, const Aperture& aperture)
      : shape_(shape), mirror_(hit_mirror(shape, aperture)) {}

  /// Follows a ray to its end.
  LUCERNA_HD void trace(Vec3 o, Vec3 d, Path<Shape>& path) const {
    path.hits = 0;
    bool on_mirror = false;
    double slope = 0.0;
    for (;;) {
      const HitEnd found = search_first(mirror_, o, d, on_mirror, slope);
      if (found.what == kHitNothing) {
        path.end = path.hits == 0 ? PathEnd::direct : PathEnd::reflected;
        path.origin = o;
        path.direction = d;
        return;
      }
      if (found.what != kHitFront || path.hits == kMaxPathHits) {
        path.end = found.what == kHitBack ? PathEnd::back : PathEnd::lost;
        return;
      }
      auto& hit = path.hit[static_cast<std::size_t>(path.hits++)];
      reflect_path(shape_, found.t_mm, o, d, hit);
      on_mirror = true;
      slope = -hit.m;  // reflection turns f' round
    }
  }

 private:
  Shape shape_;
  HitMirror<decltype(hit_table(Shape()))> mirror_;
};

/// Sensitivity of one figure of the leaving ray to a change of the surface at one of its hits: d(figure) =
/// alpha dh + beta dh_x + gamma dh_y.
struct HitAdjoint {
  double alpha = 0.0, beta = 0.0, gamma = 0.0;
};

/// Exact derivatives of a figure of the path by its adjoint, last hit first: `direction` is the figure's
/// gradient with respect to the direction that leaves hit `last`, `point` with respect to that hit's place.
/// `out[i]` belongs to hit i <= last. A hit moves along its ray as the surface rises, the normal turns with
/// the slope there and with the place, and every later hit sees both.
template <class Shape>
LUCERNA_HD void path_adjoint(const Path<Shape>& path, int last, const Vec3& direction, const Vec3& point,
                             HitAdjoint* out) {
  Vec3 a = direction, b = point;
  for (int i = last; i >= 0; --i) {
    const typename Path<Shape>::Hit& hit = path.hit[static_cast<std::size_t>(i)];
    const Vec3& g = hit.g;
    const double gg = dot(g, g), ag = dot(a, g);
    const Vec3 ad = a - (2.0 * ag / gg) * g;
    const double along = 4.0 * hit.m * ag / (gg * gg);
    const double gx = -2.0 / gg * (ag * hit.d.x + hit.m * a.x) + along * g.x;
    const double gy = -2.0 / gg * (ag * hit.d.y + hit.m * a.y) + along * g.y;
    b.x -= gx * hit.local.hxx + gy * hit.local.hxy;
    b.y -= gx * hit.local.hxy + gy * hit.local.hyy;
    const double lift = dot(b, hit.d) / hit.m;
    out[i] = {lift, -gx, -gy};
    b = b - lift * g;
    a = ad + hit.t * b;
  }
}

/// How far inside the nearest rim of the mirror (outline or hole) a point is, and the gradient of that.
struct RimDistance {
  double inside_mm = 0.0;
  Vec3 gradient;
};
LUCERNA_HD inline RimDistance rim_distance(const Aperture& aperture, double x, double y) {
  const double r = std::sqrt(x * x + y * y), per_r = r > 0.0 ? 1.0 / r : 0.0;
  RimDistance rim;
  if (aperture.shape() == ApertureShape::circle) {
    rim = {aperture.half_x_mm() - r, {-x * per_r, -y * per_r, 0.0}};
  } else {
    const double a = aperture.half_x_mm() - std::abs(x), b = aperture.half_y_mm() - std::abs(y);
    rim = a < b ? RimDistance{a, {x > 0.0 ? -1.0 : 1.0, 0.0, 0.0}}
                : RimDistance{b, {0.0, y > 0.0 ? -1.0 : 1.0, 0.0}};
  }
  const double hole = r - aperture.hole_radius_mm();
  if (aperture.hole_radius_mm() > 0.0 && hole < rim.inside_mm) rim = {hole, {x * per_r, y * per_r, 0.0}};
  return rim;
}

}  // namespace lucerna
