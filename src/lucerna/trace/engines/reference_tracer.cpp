// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/reference_tracer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "lucerna/trace/kernels/clip_line.h"

namespace lucerna {

namespace {

/// One ray on its way through the tree. f(t) = ray's height - surface's height at distance t.
class Walk {
 public:
  Walk(const Reflector& reflector, const HeightMipmap& mipmap, const Ray& ray)
      : reflector_(reflector), mipmap_(mipmap), o_(ray.origin_mm), d_(ray.direction.vec()) {}

  struct Found {
    double t = 0.0;
    SurfacePoint surface;
    bool front = true;
  };

  std::optional<Found> run() {
    double t0 = 0.0, t1 = std::numeric_limits<double>::infinity();
    const Rectangle& region = mipmap_.region();
    const HeightRange& heights = mipmap_.cell(0, 0, 0);
    clip_line(o_.x, d_.x, region.x0_mm, region.x1_mm, t0, t1);
    clip_line(o_.y, d_.y, region.y0_mm, region.y1_mm, t0, t1);
    clip_line(o_.z, d_.z, heights.low_mm, heights.high_mm, t0, t1);
    if (t0 <= t1) visit(0, 0, 0, t0, t1);
    return found_;
  }

 private:
  /// f and its derivative.
  struct Value {
    double f, df;
  };

  SurfacePoint surface(double t) const { return reflector_.surface->at(o_.x + t * d_.x, o_.y + t * d_.y); }

  Value value(double t) const {
    const SurfacePoint s = surface(t);
    return {o_.z + t * d_.z - s.z_mm, d_.z - s.dzdx * d_.x - s.dzdy * d_.y};
  }

  /// True once the hit is found. The part [t0, t1] of the ray is inside the cell.
  bool visit(int level, std::size_t ix, std::size_t iy, double t0, double t1) {
    const HeightRange& heights = mipmap_.cell(level, ix, iy);
    const double z0 = o_.z + t0 * d_.z, z1 = o_.z + t1 * d_.z;
    if (std::min(z0, z1) > heights.high_mm || std::max(z0, z1) < heights.low_mm) return false;
    // Along a line f is concave where the surface is convex: the two ends tell all of its crossings.
    if (level == mipmap_.levels() || mipmap_.convex(level, ix, iy)) return leaf(t0, t1);
    // The two middle lines cut the interval into at most three, each in one child, in the order of the ray.
    const double mx = mipmap_.line_x_mm(level + 1, 2 * ix + 1), my = mipmap_.line_y_mm(level + 1, 2 * iy + 1);
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const double tx = d_.x == 0.0 ? kNever : (mx - o_.x) / d_.x;
    const double ty = d_.y == 0.0 ? kNever : (my - o_.y) / d_.y;
    std::array<double, 4> t{t0, std::clamp(std::min(tx, ty), t0, t1), std::clamp(std::max(tx, ty), t0, t1),
                            t1};
    for (std::size_t k = 0; k < 3; ++k) {
      if (t[k] == t[k + 1]) continue;  // f changes its sign on no point
      const bool high_x = d_.x == 0.0 ? o_.x >= mx : (d_.x > 0.0) == (t[k] >= tx);
      const bool high_y = d_.y == 0.0 ? o_.y >= my : (d_.y > 0.0) == (t[k] >= ty);
      if (visit(level + 1, 2 * ix + (high_x ? 1 : 0), 2 * iy + (high_y ? 1 : 0), t[k], t[k + 1])) return true;
    }
    return false;
  }

  bool leaf(double t0, double t1) {
    const Value a = value(t0), b = value(t1);
    const bool above0 = a.f >= 0.0, above1 = b.f >= 0.0;
    if (above0 != above1) return crossing(t0, a, t1, b);
    // Same side at both ends: it may still dip to the other side and back.
    const double s = above0 ? 1.0 : -1.0;
    if (!(s * a.df < 0.0 && s * b.df > 0.0)) return false;
    double low = t0, high = t1;
    for (int i = 0; i < 60 && high - low > 1e-15 * (1.0 + high); ++i) {
      const double middle = 0.5 * (low + high);
      const Value v = value(middle);
      if ((v.f >= 0.0) != above0) return crossing(t0, a, middle, v) || crossing(middle, v, t1, b);
      (s * v.df < 0.0 ? low : high) = middle;
    }
    return false;
  }

  /// Where the parabola through both values, with the slope of the first, is zero between them: the root
  /// itself on a paraboloid.
  static double root_guess(double t0, const Value& a, double t1, const Value& b) {
    const double h = t1 - t0, bend = (b.f - a.f - a.df * h) / (h * h);
    const double w = -0.5 * (a.df + std::copysign(std::sqrt(a.df * a.df - 4.0 * bend * a.f), a.df));
    for (const double s : {a.f / w, w / bend}) {
      if (s > 0.0 && s < h) return t0 + s;
    }
    return 0.5 * (t0 + t1);
  }

  /// Finds the root between t0 and t1, where f changes sign, by Newton's method held inside a shrinking
  /// bracket.
  bool crossing(double t0, const Value& a, double t1, const Value& b) {
    const bool from_above = a.f >= 0.0;
    double low = t0, high = t1, t = root_guess(t0, a, t1, b);
    for (int i = 0; i < 200; ++i) {
      const Value v = value(t);
      ((v.f >= 0.0) == from_above ? low : high) = t;
      double next = t - v.f / v.df;
      if (!(next > low && next < high)) next = 0.5 * (low + high);
      if (std::abs(next - t) <= 1e-15 * (1.0 + std::abs(t)) || next == low || next == high) break;
      t = next;
    }
    if (!reflector_.aperture.contains(o_.x + t * d_.x, o_.y + t * d_.y)) return false;
    found_ = Found{t, surface(t), from_above};
    return true;
  }

  const Reflector& reflector_;
  const HeightMipmap& mipmap_;
  Vec3 o_, d_;
  std::optional<Found> found_;
};

}  // namespace

ReferenceTracer::ReferenceTracer(const Reflector& reflector, int levels) : reflector_(reflector) {
  double high = 0.0;
  if (reflector.curve) {
    curve_ = view_of(*reflector.curve, reflector.aperture);
    high = reflector.curve->heights().high_mm;
  } else if (const FacetedSurface* surface = faceted(reflector)) {
    facets_.emplace(*surface, reflector.aperture);
    high = facets_->view().high;
  } else if (const auto* array = dynamic_cast<const LensArraySurface*>(reflector.surface.get())) {
    array_ = array;
    high = array->range(reflector.aperture.bounds()).high_mm;
  } else {
    mipmap_.emplace(reflector, levels);
    high = mipmap_->cell(0, 0, 0).high_mm;
  }
  offset_mm_ = 1e-11 * (1.0 + reflector.aperture.outer_radius_mm() + std::abs(high));
}

std::optional<MirrorHit> ReferenceTracer::first_hit_with_curve(const Ray& ray) const {
  const CurveHit hit = CurveWalk(curve_, ray.origin_mm, ray.direction.vec(), 0.0).run();
  if (!hit.is_hit) return std::nullopt;
  const Vec3 off = (hit.front ? offset_mm_ : -offset_mm_) * hit.normal;
  return MirrorHit{hit.t, ray.at(hit.t) + off, Direction::from_unit(hit.normal), hit.front};
}

std::optional<MirrorHit> ReferenceTracer::first_hit_with_facets(const Ray& ray) const {
  const FacetHit hit = intersect_facets(facets_->view(), ray.origin_mm, ray.direction.vec(), 0.0);
  if (!hit.is_hit) return std::nullopt;
  const Direction normal = Direction::from({-hit.dzdx, -hit.dzdy, 1.0});
  const Vec3 off = (hit.front ? offset_mm_ : -offset_mm_) * normal.vec();
  return MirrorHit{hit.t, ray.at(hit.t) + off, normal, hit.front};
}

std::optional<MirrorHit> ReferenceTracer::first_hit_with_array(const Ray& ray) const {
  const auto hit = first_lens_array_hit(*array_, reflector_.aperture, ray);
  if (!hit) return std::nullopt;
  const bool front = dot(ray.direction, hit->normal) < 0.0;
  const Vec3 off = (front ? offset_mm_ : -offset_mm_) * hit->normal.vec();
  return MirrorHit{hit->t_mm, ray.at(hit->t_mm) + off, hit->normal, front};
}

std::optional<MirrorHit> ReferenceTracer::first_hit(const Ray& ray) const {
  if (reflector_.curve) return first_hit_with_curve(ray);
  if (facets_) return first_hit_with_facets(ray);
  if (array_ != nullptr) return first_hit_with_array(ray);
  const auto found = Walk(reflector_, *mipmap_, ray).run();
  if (!found) return std::nullopt;
  return hit_on(found->surface, ray.at(found->t), found->t, found->front);
}

MirrorHit ReferenceTracer::hit_on(const SurfacePoint& s, const Vec3& p, double t_mm, bool front) const {
  return {t_mm,
          {p.x, p.y, s.z_mm + (front ? offset_mm_ : -offset_mm_)},
          Direction::from({-s.dzdx, -s.dzdy, 1.0}),
          front};
}

}  // namespace lucerna
