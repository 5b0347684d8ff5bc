// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/optics/shapes/swept_curve.h"

namespace lucerna {

// The first hit of a ray with a swept curve (docs/theory/height-fields.md), one ray at a time in
// double: small functions that CPU and GPU share.

/// A SweptCurve and its aperture as a kernel reads them; points into the curve.
struct CurveView {
  const CurvePiece* pieces;
  const CurveNode* nodes;
  std::int32_t node_count;
  bool trough;
  bool round;                   ///< aperture: a circle of half_x, or a rectangle
  double half_x, half_y, hole;  ///< half sizes and the hole's radius
  double overlap_mm;  ///< pieces are taken this much longer: far above rounding, far below a wavelength
};

/// Where a ray hits the curve.
struct CurveHit {
  bool is_hit = false, front = true;
  double t = 0.0;
  Vec3 normal;  ///< unit, towards the reflecting side
};

/// One ray on its way. Seen from the axis (or the trough's middle plane) the ray runs through the half plane
/// (rho, z) with rho^2 = a t^2 + 2 b t + c; rho falls until t = turn_ and rises from there.
class CurveWalk {
 public:
  /// `tolerance_mm` > 0: the ray was just reflected here and starts within this distance of the curve, its
  /// numbers being rounded; it is put a hair in front of it.
  LUCERNA_HD CurveWalk(const CurveView& view, const Vec3& o, const Vec3& d, double tolerance_mm)
      : v_(view), o_(o), d_(d) {
    if (tolerance_mm > 0.0) offset_start(tolerance_mm);
    a_ = d_.x * d_.x + (v_.trough ? 0.0 : d_.y * d_.y);
    b_ = o_.x * d_.x + (v_.trough ? 0.0 : o_.y * d_.y);
    c_ = o_.x * o_.x + (v_.trough ? 0.0 : o_.y * o_.y);
    const double twist = v_.trough ? 0.0 : o_.x * d_.y - o_.y * d_.x;
    turn_ = a_ > 0.0 ? -b_ / a_ : 0.0;
    least2_ = a_ > 0.0 ? twist * twist / a_ : c_;
  }

  LUCERNA_HD CurveHit run() {
    best_.t = kNever;
    for (std::int32_t i = 0; i < v_.node_count;) {
      const CurveNode& node = v_.nodes[i];
      if (misses(node)) {
        i = node.skip;
        continue;
      }
      if (node.piece >= 0) intersect_piece(v_.pieces[node.piece]);
      ++i;
    }
    return best_;
  }

 private:
  static constexpr double kNever = 1e300;
  /// A Newton step this small, taken, leaves an error far below rounding: each squares the one before.
  static constexpr double kLastStep = 1e-8;

  // std::fmin and fmax are calls, for what they do with NaN; there is none here.
  LUCERNA_HD static double smaller(double a, double b) { return b < a ? b : a; }
  LUCERNA_HD static double larger(double a, double b) { return a < b ? b : a; }

  LUCERNA_HD double rho2(double t) const {
    const double s = t - turn_;
    return a_ > 0.0 ? least2_ + a_ * s * s : c_;
  }
  LUCERNA_HD double rho(double t) const { return std::sqrt(rho2(t)); }

  /// True if the ray is not in the box before the best hit.
  LUCERNA_HD bool misses(const CurveNode& n) const {
    double t0 = 0.0, t1 = best_.t;
    const double z0 = n.z0 - v_.overlap_mm, z1 = n.z1 + v_.overlap_mm;
    if (d_.z == 0.0) {
      if (o_.z < z0 || o_.z > z1) return true;
    } else {
      const double p = (z0 - o_.z) / d_.z, q = (z1 - o_.z) / d_.z;
      t0 = larger(t0, smaller(p, q));
      t1 = smaller(t1, larger(p, q));
      if (t0 > t1) return true;
    }
    const double r1 = n.r1 + v_.overlap_mm, r0 = n.r0 - v_.overlap_mm;
    if (rho2(smaller(larger(turn_, t0), t1)) > r1 * r1) return true;
    return r0 > 0.0 && larger(rho2(t0), rho2(t1)) < r0 * r0;
  }

  /// Height of the ray in front of the piece at distance t, its derivative, and the piece's parameter there.
  struct Value {
    double f, df, s;
  };
  LUCERNA_HD static double cubic(const double (&k)[4], double s) {
    return k[0] + s * (k[1] + s * (k[2] + s * k[3]));
  }
  LUCERNA_HD static double cubic_slope(const double (&k)[4], double s) {
    return k[1] + s * (2.0 * k[2] + 3.0 * s * k[3]);
  }
  /// Where the piece's own coordinate is `m`: Newton's method; the piece is nearly straight.
  LUCERNA_HD static double parameter(const double (&k)[4], double from, double to, double m) {
    double s = (m - from) / (to - from);
    for (int i = 0; i < 8; ++i) {
      s = smaller(larger(s, 0.0), 1.0);
      const double step = (cubic(k, s) - m) / cubic_slope(k, s);
      s -= step;
      if (std::abs(step) < kLastStep) break;
    }
    return smaller(larger(s, 0.0), 1.0);
  }
  LUCERNA_HD Value value(const CurvePiece& p, double t) const {
    const double r = rho(t), z = o_.z + t * d_.z;
    const double dr = r > 0.0 ? a_ * (t - turn_) / r : 0.0;
    const double s = parameter(p.along_z ? p.z : p.r, p.from, p.to, p.along_z ? z : r);
    const double per = cubic_slope(p.r, s) / cubic_slope(p.z, s);
    const double sign = p.to > p.from ? 1.0 : -1.0;
    // The reflecting side is on the left of the way from `from` to `to`.
    if (p.along_z) return {sign * (cubic(p.r, s) - r), sign * (per * d_.z - dr), s};
    return {sign * (z - cubic(p.z, s)), sign * (d_.z - dr / per), s};
  }
  LUCERNA_HD static bool in_front(const Value& v) { return v.f >= 0.0; }

  /// Puts the start a hair in front of the piece that it is within `tolerance` of: more than what a
  /// neighbour's curve is off this piece's tangent there. The second step takes off what the first leaves
  /// where the curve bends.
  LUCERNA_HD void offset_start(double tolerance) {
    const double across = to_axis();
    for (std::int32_t i = 0; i < v_.node_count;) {
      const CurveNode& n = v_.nodes[i];
      if (o_.z < n.z0 - tolerance || o_.z > n.z1 + tolerance || across < n.r0 - tolerance ||
          across > n.r1 + tolerance) {
        i = n.skip;
        continue;
      }
      ++i;
      if (n.piece < 0) continue;
      const CurvePiece& p = v_.pieces[n.piece];
      const double m = p.along_z ? o_.z : across;
      if (m < smaller(p.from, p.to) - tolerance || m > larger(p.from, p.to) + tolerance) continue;
      if (!step_in_front(p, tolerance)) continue;
      step_in_front(p, tolerance);
      return;
    }
  }

  /// Moves the start along the normal of the piece beside it to a hair in front of its tangent there; false
  /// if it is farther than `tolerance` from it.
  LUCERNA_HD bool step_in_front(const CurvePiece& p, double tolerance) {
    const double across = to_axis(), hair = 100.0 * v_.overlap_mm;
    const double s = parameter(p.along_z ? p.z : p.r, p.from, p.to, p.along_z ? o_.z : across);
    const Vec3 n = normal(p, s, o_.x, o_.y, across);
    const double off = (across - cubic(p.r, s)) * flat_normal(p, s) + (o_.z - cubic(p.z, s)) * n.z;
    if (std::fabs(off) > tolerance) return false;
    o_ += (hair - off) * n;
    return true;
  }

  /// Distance of the start from the axis, or a trough's middle plane.
  LUCERNA_HD double to_axis() const {
    return v_.trough ? std::fabs(o_.x) : std::sqrt(o_.x * o_.x + o_.y * o_.y);
  }

  /// The part of the normal at `s` that points away from the axis.
  LUCERNA_HD static double flat_normal(const CurvePiece& p, double s) {
    const double dr = cubic_slope(p.r, s), dz = cubic_slope(p.z, s);
    return -dz / std::sqrt(dr * dr + dz * dz);
  }
  LUCERNA_HD Vec3 normal(const CurvePiece& p, double s, double x, double y, double across) const {
    const double dr = cubic_slope(p.r, s), dz = cubic_slope(p.z, s), length = std::sqrt(dr * dr + dz * dz);
    const double nr = -dz / length, nz = dr / length;
    if (v_.trough) return {x < 0.0 ? -nr : nr, 0.0, nz};
    const double per = across > 0.0 ? nr / across : 0.0;
    return {x * per, y * per, nz};
  }

  /// Looks for hits with one piece: the ray's part beside it is cut where the ray turns, so that rho is
  /// monotone in each part.
  LUCERNA_HD void intersect_piece(const CurvePiece& p) {
    const double low = smaller(p.from, p.to) - v_.overlap_mm, high = larger(p.from, p.to) + v_.overlap_mm;
    if (p.along_z) {
      if (d_.z == 0.0) {
        if (o_.z < low || o_.z > high) return;
        // No farther than where it is surely outside the curve.
        const double far = larger(std::fabs(cubic(p.r, 0.0)), std::fabs(cubic(p.r, 1.0))) * 2.0 + 1.0;
        if (!(a_ > 0.0) || least2_ > far * far) return;
        const double w = std::sqrt((far * far - least2_) / a_);
        part(p, turn_ - w, turn_);
        part(p, turn_, turn_ + w);
        return;
      }
      const double t0 = (low - o_.z) / d_.z, t1 = (high - o_.z) / d_.z;
      const double begin = smaller(t0, t1), end = larger(t0, t1);
      part(p, begin, smaller(end, larger(begin, turn_)));
      part(p, larger(begin, turn_), end);
      return;
    }
    if (high * high < least2_ || high < 0.0) return;
    if (!(a_ > 0.0)) {  // along the axis: one point of the piece, met once
      if (low > 0.0 && c_ < low * low) return;
      const double z = cubic(p.z, parameter(p.r, p.from, p.to, rho(0.0)));
      const double t = (z - o_.z) / d_.z;
      part(p, t - 1.0, t + 1.0);
      return;
    }
    const double outer = std::sqrt((high * high - least2_) / a_);
    const double inner = low > 0.0 && low * low > least2_ ? std::sqrt((low * low - least2_) / a_) : 0.0;
    part(p, turn_ - outer, turn_ - inner);
    part(p, turn_ + inner, turn_ + outer);
  }

  /// A place on the ray and its height there.
  struct End {
    double t, f;
  };

  LUCERNA_HD LUCERNA_HD_CALL void part(const CurvePiece& p, double t0, double t1) {
    t0 = larger(t0, 0.0);
    t1 = smaller(t1, best_.t);
    if (!(t0 < t1)) return;
    const Value a = value(p, t0), b = value(p, t1);
    const bool front = in_front(a);
    if (front != in_front(b)) {
      crossing(p, {t0, a.f}, {t1, b.f}, front);
      return;
    }
    // On the same side at both ends it may still go over and come back.
    const double sign = front ? 1.0 : -1.0;
    if (!(sign * a.df < 0.0 && sign * b.df > 0.0)) return;
    double low = t0, high = t1;
    for (int i = 0; i < 60 && high - low > 1e-15 * (1.0 + high); ++i) {
      const double middle = 0.5 * (low + high);
      const Value v = value(p, middle);
      if (in_front(v) != front) {
        crossing(p, {t0, a.f}, {middle, v.f}, front);
        crossing(p, {middle, v.f}, {t1, b.f}, !front);
        return;
      }
      (sign * v.df < 0.0 ? low : high) = middle;
    }
  }

  /// The root between t0 and t1, where the side changes, by Newton's method inside a shrinking bracket.
  LUCERNA_HD LUCERNA_HD_CALL void crossing(const CurvePiece& p, const End& first, const End& last,
                                           bool front) {
    double low = first.t, high = last.t;
    // Where the chord crosses; the curve is nearly straight beside it.
    double t = low + (high - low) * (first.f / (first.f - last.f));
    if (!(t > low && t < high)) t = 0.5 * (low + high);
    Value v = value(p, t);
    for (int i = 0; i < 100; ++i) {
      (in_front(v) == front ? low : high) = t;
      double next = t - v.f / v.df;
      const bool newton = next >= low && next <= high;
      if (!newton) next = 0.5 * (low + high);
      if (next == t) break;
      const bool last_step = newton && std::abs(next - t) <= kLastStep;
      t = next;
      v = value(p, t);
      if (last_step || t == low || t == high) break;
    }
    if (!(t < best_.t)) return;
    const double x = o_.x + t * d_.x, y = o_.y + t * d_.y, r2 = x * x + y * y;
    if (r2 < v_.hole * v_.hole) return;
    if (v_.round ? r2 > v_.half_x * v_.half_x : std::abs(x) > v_.half_x || std::abs(y) > v_.half_y) return;
    best_ = {true, front, t, normal(p, v.s, x, y, std::sqrt(r2))};
  }

  const CurveView& v_;
  Vec3 o_, d_;
  double a_, b_, c_, turn_, least2_;
  CurveHit best_;
};

}  // namespace lucerna
