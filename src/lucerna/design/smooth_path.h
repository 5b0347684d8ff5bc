// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lucerna/core/direction.h"
#include "lucerna/core/host_device.h"
#include "lucerna/reflector/aperture.h"
#include "lucerna/reflector/smooth_view.h"

namespace lucerna {

/// How a ray's way through a single mirror ends.
enum class PathEnd { direct, reflected, back, lost };

/// Reflections that a path keeps; a ray with more is lost.
inline constexpr int kMostPathHits = 24;

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
  std::array<Hit, kMostPathHits> hit;
  /// Where the ray leaves from, the last hit or its start, and along what.
  Vec3 origin, direction;
};

/// Traces rays through one mirror (Shape: a view of smooth_view.h) z = r^2 / (4 f) + s(x, y) over an
/// aperture, all in the mirror's frame.
///
/// Along a ray, f(t) = q(t) - s(x(t), y(t)) with q the quadratic of the base paraboloid. Where |s''| <= B
/// along every direction, f(t + tau) >= f + f' tau - A tau^2 with A = c2 + B |d_xy|^2 / 2: the positive root
/// of the right side never passes the first zero of f, and converges to it quadratically. So the first hit is
/// found without hierarchy or sampling, however often the ray crosses. A has two values: B for the cells
/// about the place, good for so many cells, and for the whole surface; the longest step is taken. Where the
/// bounds show that f falls all the way to its only zero, the steps of the paraboloid's own curvature are
/// taken instead, which need about two looks. The band of s skips the air above the surface at once.
/// Immutable, thread safe.
template <class Shape>
class SmoothTracer {
 public:
  LUCERNA_HD SmoothTracer(const Shape& shape, const Aperture& aperture)
      : shape_(shape), aperture_(aperture), k_(0.25 / shape.focal_mm) {}

  /// Follows a ray to its end.
  LUCERNA_HD void trace(Vec3 o, Vec3 d, Path<Shape>& path) const {
    path.hits = 0;
    bool on_surface = false;
    double slope = 0.0;
    for (;;) {
      const Found found = first_hit(o, d, on_surface, slope);
      if (found.what == What::nothing) {
        path.end = path.hits == 0 ? PathEnd::direct : PathEnd::reflected;
        path.origin = o;
        path.direction = d;
        return;
      }
      if (found.what == What::back || found.what == What::failed || path.hits == kMostPathHits) {
        path.end = found.what == What::back ? PathEnd::back : PathEnd::lost;
        return;
      }
      typename Path<Shape>::Hit& hit = path.hit[static_cast<std::size_t>(path.hits++)];
      const double x = o.x + found.t * d.x, y = o.y + found.t * d.y;
      hit.local = shape_.local(x, y);
      hit.d = d;
      hit.x = x;
      hit.y = y;
      hit.t = found.t;
      hit.g = {-hit.local.hx, -hit.local.hy, 1.0};
      hit.m = dot(d, hit.g);
      o = {x, y, o.z + found.t * d.z};
      d = d - (2.0 * hit.m / dot(hit.g, hit.g)) * hit.g;
      on_surface = true;
      slope = -hit.m;  // reflection turns f' round
    }
  }

 private:
  enum class What { nothing, front, back, failed };
  struct Found {
    What what = What::nothing;
    double t = 0.0;
  };

  /// Part of the ray over the aperture's outer outline.
  LUCERNA_HD void clip(const Vec3& o, const Vec3& d, double& t0, double& t1) const {
    if (aperture_.shape() == ApertureShape::circle) {
      const double a = d.x * d.x + d.y * d.y + 1e-30, b = o.x * d.x + o.y * d.y;
      const double r = aperture_.half_x_mm(), c = o.x * o.x + o.y * o.y - r * r;
      const double root = b * b - a * c;
      if (root < 0.0) {
        t1 = -1.0;
        return;
      }
      t0 = std::max(t0, (-b - std::sqrt(root)) / a);
      t1 = std::min(t1, (-b + std::sqrt(root)) / a);
      return;
    }
    slab(o.x, d.x, aperture_.half_x_mm(), t0, t1);
    slab(o.y, d.y, aperture_.half_y_mm(), t0, t1);
  }
  LUCERNA_HD static void slab(double o, double d, double half, double& t0, double& t1) {
    if (d == 0.0) {
      if (std::abs(o) > half) t1 = -1.0;
      return;
    }
    const double a = (-half - o) / d, b = (half - o) / d;
    t0 = std::max(t0, std::min(a, b));
    t1 = std::min(t1, std::max(a, b));
  }

  /// Positive root of f + df t - a t^2.
  LUCERNA_HD static double zero_ahead(double f, double df, double a) {
    const double w = std::sqrt(std::max(0.0, df * df + 4.0 * a * f));
    return df > 0.0 ? (df + w) / (2.0 * a) : 2.0 * f / (w - df);
  }

  /// `slope` is f' where the ray starts on the surface.
  LUCERNA_HD Found first_hit(const Vec3& o, const Vec3& d, bool on_surface, double slope) const {
    double t = 0.0, t_end = std::numeric_limits<double>::infinity();
    clip(o, d, t, t_end);
    if (!(t <= t_end)) return {};
    const double across = d.x * d.x + d.y * d.y;
    const double c0 = o.z - k_ * (o.x * o.x + o.y * o.y), c1 = d.z - 2.0 * k_ * (o.x * d.x + o.y * d.y);
    const double c2 = k_ * across + 1e-30, bend = c2 + 0.5 * shape_.bend_bound * across;
    const double cell_t = shape_.cell_mm() / (std::sqrt(across) + 1e-30);
    const HeightRange& band = shape_.band;
    // q is above the band between `rise` and `fall`.
    double rise = 0.0, fall = -1.0;
    const double above = c0 - band.high_mm, root = c1 * c1 + 4.0 * c2 * above;
    if (root > 0.0) {
      const double w = std::sqrt(root);
      rise = c1 > 0.0 ? -2.0 * above / (c1 + w) : (c1 - w) / (2.0 * c2);
      fall = c1 > 0.0 ? (c1 + w) / (2.0 * c2) : 2.0 * above / (w - c1);
    }
    // Beyond `low` the ray is below the band.
    const double under = c0 - band.low_mm, low_root = c1 * c1 + 4.0 * c2 * under;
    const double low = low_root > 0.0 ? (c1 + std::sqrt(low_root)) / (2.0 * c2) : -1.0;
    double side = on_surface ? 1.0 : 0.0;  // +1 in front of the mirror, -1 behind it; set by the first look
    bool only_one = false;                 // f falls from here to its only zero: plain steps may overshoot
    bool known = on_surface;               // f and df of this place are known without a look
    double f = 0.0, df = on_surface ? slope : 0.0;
    constexpr int kMostSteps = 200;
    for (int step = 0; step < kMostSteps; ++step) {
      if (!only_one && t >= rise && t < fall) {
        side = 1.0;
        t = fall;
        known = false;
      }
      if (t > t_end) {
        if (!only_one) return {};
        t = t_end;  // beyond it nothing is known of s, and if f has not fallen to 0 here, there is no hit
      }
      const double at_x = o.x + t * d.x, at_y = o.y + t * d.y;
      if (!known) {
        const ShapeOffset s = shape_.offset(at_x, at_y);
        f = c0 + t * (c1 - t * c2) - s.s;
        df = c1 - 2.0 * t * c2 - (s.sx * d.x + s.sy * d.y);
        if (side == 0.0) side = f < 0.0 ? -1.0 : 1.0;
        f *= side;
        df *= side;
        if (!only_one) f = std::max(0.0, f);
        if (only_one && t == t_end && f > kTouch_mm) return {};
      }
      known = false;
      if (std::abs(f) <= kTouch_mm && df < 0.0) {
        const double hit_t = t - f / df;
        const double x = o.x + hit_t * d.x, y = o.y + hit_t * d.y;
        const double hole = aperture_.hole_radius_mm();
        if (hit_t > t_end) return {};
        if (x * x + y * y >= hole * hole) return {side > 0.0 ? What::front : What::back, hit_t};
        side = -side;  // through the hole, to the other side
        df = -df;
        f = 0.0;
        t = hit_t;
        only_one = false;
      }
      const double* const near = shape_.near_bends_at(at_x, at_y);
      const double behind = side > 0.0 ? 0.0 : 2.0 * c2;  // there the base bends the other way
      // On a stretch as long as `good`, |f''| is at most twice `most`.
      double good = near_cells(0) * cell_t, most = c2 + 0.5 * near[0] * across;
      if (side > 0.0 && df < 0.0 && low > t) {
        const double falls = 2.0 * ((low - t < good ? most : bend) - 2.0 * c2);
        if (df + std::max(0.0, falls) * (low - t) < 0.0) only_one = true;
      }
      double ahead = only_one ? zero_ahead(f, df, c2) : 0.0;
      for (int size = 0; !only_one && size <= kNearSizes; ++size) {
        const double zero = zero_ahead(f, df, std::max(most - behind, 1e-30));
        ahead = std::max(ahead, std::min(zero, good));
        if (zero <= good) break;
        const bool last = size + 1 >= kNearSizes;
        good = last ? std::numeric_limits<double>::infinity() : near_cells(size + 1) * cell_t;
        most = last ? bend : c2 + 0.5 * near[size + 1] * across;
      }
      if (!(ahead > 0.0) && !only_one) return {What::failed, t};
      t += ahead;
    }
    return {What::failed, t};
  }

  /// Height above the surface at which a ray has arrived; a last Newton step follows.
  static constexpr double kTouch_mm = 1e-7;

  Shape shape_;
  Aperture aperture_;
  double k_;
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
