// SPDX-License-Identifier: Apache-2.0
#pragma once

// Where a ray first hits a smooth mirror, for any width of vectors (simd_double.h, scalar_double.h). Included
// by files that are compiled for one instruction set each: no headers of the standard library with inline
// functions.

#include <stddef.h>
#include <stdint.h>

#include "lucerna/host_device.h"
#include "lucerna/optics/shapes/near_cells.h"

namespace lucerna {

/// A uniform row of knots.
struct HitRow {
  double start_mm, per_mm;
  int32_t intervals;
};
/// The splines of smooth_view.h as a search reads them: bicubic, or cubic of the radius.
struct BsplineHitTable {
  HitRow x, y;
  const double* coefficients;
  const double* near_curvatures;
};
struct RevolutionHitTable {
  HitRow r;
  const double* coefficients;
  const double* near_curvatures;
};

/// A mirror z = k r^2 + s(x, y), s one of the tables', over an aperture (all in mm).
template <class Table>
struct HitMirror {
  Table spline;
  double k;
  double low, high;  ///< s lies between them over the aperture
  double curvature;  ///< bound of |s''| along any direction
  double cell;       ///< least width of a cell of knots
  bool round;        ///< aperture: circle of half_x, or rectangle; less a hole
  double half_x, half_y, hole;
};

/// How a search ends.
enum : int32_t { kHitNothing = 0, kHitFront = 1, kHitBack = 2, kHitFailed = 3 };

/// Rays of a batch, padded by kHitPadding at the end.
inline constexpr size_t kHitBatch = 512, kHitPadding = 8;
struct HitRays {
  alignas(64) double x[kHitBatch + kHitPadding], y[kHitBatch + kHitPadding], z[kHitBatch + kHitPadding];
  alignas(64) double dx[kHitBatch + kHitPadding], dy[kHitBatch + kHitPadding], dz[kHitBatch + kHitPadding];
  /// 1 for a ray that starts on the mirror's front, with f' there (see HitSearch).
  alignas(64) double on_mirror[kHitBatch + kHitPadding], slope[kHitBatch + kHitPadding];
};
struct HitEnds {
  int32_t what[kHitBatch];
  double t[kHitBatch];
};

/// The spline at a place: value, slopes, and bounds of its bend nearby.
template <class V>
struct HitLook {
  V s, sx, sy, near[kNearSizes];
};

template <class V>
struct HitBasis {
  V b[4], d[4];  ///< the four cubic B-splines that count (optics/shapes/cubic_basis.h) and their slopes
};
template <class V>
LUCERNA_HD inline HitBasis<V> hit_basis(V t) {
  const V u = V(1.0) - t, t2 = t * t, u2 = u * u;
  HitBasis<V> out;
  out.b[0] = u2 * u * V(1.0 / 6.0);
  out.b[1] = V(2.0 / 3.0) - V(0.5) * t2 * (V(2.0) - t);
  out.b[2] = V(2.0 / 3.0) - V(0.5) * u2 * (V(2.0) - u);
  out.b[3] = t2 * t * V(1.0 / 6.0);
  out.d[0] = V(-0.5) * u2;
  out.d[1] = t * (V(1.5) * t - V(2.0));
  out.d[2] = u * (V(2.0) - V(1.5) * u);
  out.d[3] = V(0.5) * t2;
  return out;
}

/// Cell of a row (a whole number) and place within it.
template <class V>
LUCERNA_HD inline V hit_cell(const HitRow& row, V at, V& t) {
  const V u = (at - V(row.start_mm)) * V(row.per_mm);
  const V cell = min(max(floor(u), V(0.0)), V(static_cast<double>(row.intervals - 1)));
  t = u - cell;
  return cell;
}

template <class V>
LUCERNA_HD inline HitLook<V> hit_look(const BsplineHitTable& s, V x, V y) {
  V tx, ty;
  const V cx = hit_cell(s.x, x, tx), cy = hit_cell(s.y, y, ty);
  const HitBasis<V> bx = hit_basis(tx), by = hit_basis(ty);
  const int stride = s.x.intervals + 3;
  const V first = cy * V(static_cast<double>(stride)) + cx;
  HitLook<V> look;
  for (int j = 0; j < 4; ++j) {
    V c[4];
    gather4(s.coefficients + static_cast<ptrdiff_t>(j) * stride, first, c);
    const V value = bx.b[0] * c[0] + bx.b[1] * c[1] + bx.b[2] * c[2] + bx.b[3] * c[3];
    const V slope = bx.d[0] * c[0] + bx.d[1] * c[1] + bx.d[2] * c[2] + bx.d[3] * c[3];
    look.s = j == 0 ? by.b[0] * value : look.s + by.b[j] * value;
    look.sx = j == 0 ? by.b[0] * slope : look.sx + by.b[j] * slope;
    look.sy = j == 0 ? by.d[0] * value : look.sy + by.d[j] * value;
  }
  look.sx = look.sx * V(s.x.per_mm);
  look.sy = look.sy * V(s.y.per_mm);
  const V cell = V(static_cast<double>(kNearSizes)) * (cy * V(static_cast<double>(s.x.intervals)) + cx);
  for (int k = 0; k < kNearSizes; ++k) look.near[k] = gather(s.near_curvatures + k, cell);
  return look;
}

template <class V>
LUCERNA_HD inline HitLook<V> hit_look(const RevolutionHitTable& s, V x, V y) {
  const V r = sqrt(x * x + y * y);
  V t;
  const V cell = hit_cell(s.r, r, t);
  const HitBasis<V> b = hit_basis(t);
  V c[4];
  gather4(s.coefficients, cell, c);
  HitLook<V> look;
  look.s = b.b[0] * c[0] + b.b[1] * c[1] + b.b[2] * c[2] + b.b[3] * c[3];
  const V slope = (b.d[0] * c[0] + b.d[1] * c[1] + b.d[2] * c[2] + b.d[3] * c[3]) * V(s.r.per_mm);
  const V per_r = select(V(0.0) < r, slope / r, V(0.0));
  look.sx = x * per_r;
  look.sy = y * per_r;
  for (int k = 0; k < kNearSizes; ++k) {
    look.near[k] = gather(s.near_curvatures + k, V(static_cast<double>(kNearSizes)) * cell);
  }
  return look;
}

/// Searches of as many rays as V has lanes.
///
/// Along a ray, f(t) = q(t) - s(x(t), y(t)) with q the quadratic of the base paraboloid. Where |s''| <= B
/// along every direction, f(t + tau) >= f + f' tau - A tau^2 with A = c2 + B |d_xy|^2 / 2: the positive root
/// of the right side never passes the first zero of f, and converges to it quadratically. So the first hit is
/// found without hierarchy or sampling, however often the ray crosses. A has several values: B for the cells
/// about the place, good for so many cells, and for the whole surface; the longest step is taken. Where the
/// bounds show that f falls all the way to its only zero, the steps of the paraboloid's own curvature are
/// taken instead, which need about two looks. The band of s skips the air above the surface at once, and what
/// is below it. Behind the mirror all is the same with -f.
template <class V, class Table>
class HitSearch {
 public:
  using Mask = typename V::Mask;

  /// Begins at o along the unit vector d; where on_mirror is 1, on the mirror's front, which f leaves with
  /// `slope`: there the bound of the whole surface gives the first step without a look, and nearly every ray
  /// leaves the band of s with it. The lanes that have to look; the others meet nothing.
  LUCERNA_HD Mask begin(const HitMirror<Table>& m, const V* o, const V* d, V on_mirror, V slope) {
    x_ = o[0];
    y_ = o[1];
    dx_ = d[0];
    dy_ = d[1];
    clip(m);
    across_ = dx_ * dx_ + dy_ * dy_;
    c0_ = o[2] - V(m.k) * (x_ * x_ + y_ * y_);
    c1_ = d[2] - V(2.0 * m.k) * (x_ * dx_ + y_ * dy_);
    c2_ = V(m.k) * across_ + V(1e-30);
    cell_t_ = V(m.cell) / (sqrt(across_) + V(1e-30));
    find_band(m);
    side_ = on_mirror;
    only_one_ = V(0.0);
    f_ = V(0.0);
    df_ = V(0.0);
    looks_ = V(0.0);
    what_ = V(static_cast<double>(kHitNothing));
    const V away = max(slope, V(0.0)) / (c2_ + V(0.5 * m.curvature) * across_);
    t_ = t_ + select(is(on_mirror), away, V(0.0));
    skip_air(t_ <= t_end_);
    return t_ <= t_end_;
  }

  /// One look at the surface and the step that follows from it; the lanes whose search has ended.
  LUCERNA_HD Mask step(const HitMirror<Table>& m) {
    const HitLook<V> look = hit_look(m.spline, x_ + t_ * dx_, y_ + t_ * dy_);
    take(look);
    Mask ended = is(only_one_) & (t_end_ <= t_) & (V(kTouch_mm) < f_);
    ended = ended | touch(m, ended);
    const V ahead = step_length(m, look);
    looks_ = looks_ + V(1.0);
    const Mask stuck = (~(V(0.0) < ahead) & ~is(only_one_)) | (V(kMaxLooks) <= looks_);
    what_ = select(stuck & ~ended, V(static_cast<double>(kHitFailed)), what_);
    ended = ended | stuck;
    t_ = select(ended, t_, t_ + ahead);
    skip_air(~ended);
    // Beyond the end nothing is known of s, and if f has not fallen to 0 there, there is no hit.
    const Mask over = (t_end_ < t_) & ~ended;
    t_ = select(over & is(only_one_), t_end_, t_);
    return ended | (over & ~is(only_one_));
  }

  /// Lanes of `m` take over another's search.
  LUCERNA_HD void replace(Mask m, const HitSearch& o) {
    x_ = select(m, o.x_, x_);
    y_ = select(m, o.y_, y_);
    dx_ = select(m, o.dx_, dx_);
    dy_ = select(m, o.dy_, dy_);
    across_ = select(m, o.across_, across_);
    c0_ = select(m, o.c0_, c0_);
    c1_ = select(m, o.c1_, c1_);
    c2_ = select(m, o.c2_, c2_);
    cell_t_ = select(m, o.cell_t_, cell_t_);
    rise_ = select(m, o.rise_, rise_);
    fall_ = select(m, o.fall_, fall_);
    reach_ = select(m, o.reach_, reach_);
    low_ = select(m, o.low_, low_);
    t_end_ = select(m, o.t_end_, t_end_);
    t_ = select(m, o.t_, t_);
    side_ = select(m, o.side_, side_);
    only_one_ = select(m, o.only_one_, only_one_);
    f_ = select(m, o.f_, f_);
    df_ = select(m, o.df_, df_);
    looks_ = select(m, o.looks_, looks_);
    what_ = select(m, o.what_, what_);
  }

  /// How a lane that has ended did (kHitNothing, ...), and where.
  LUCERNA_HD V what() const { return what_; }
  LUCERNA_HD V t() const { return t_; }

 private:
  /// Height above the surface at which a ray has arrived; a last Newton step follows, which leaves 1e-12 of
  /// it.
  static constexpr double kTouch_mm = 1e-6;
  static constexpr double kMaxLooks = 200.0;

  LUCERNA_HD static Mask is(V flag) { return V(0.5) < flag; }
  LUCERNA_HD static bool any(Mask a) { return bits(a) != 0; }

  /// Part of the ray over the aperture's outer outline.
  LUCERNA_HD void clip(const HitMirror<Table>& m) {
    t_ = V(0.0);
    t_end_ = V(__builtin_inf());
    if (m.round) {
      const V a = dx_ * dx_ + dy_ * dy_ + V(1e-30), b = x_ * dx_ + y_ * dy_;
      const V root = b * b - a * (x_ * x_ + y_ * y_ - V(m.half_x * m.half_x));
      const V w = sqrt(max(root, V(0.0))), minus_b = V(0.0) - b;
      t_ = max((minus_b - w) / a, t_);
      t_end_ = select(root < V(0.0), V(-1.0), (minus_b + w) / a);
      return;
    }
    slab(x_, dx_, m.half_x);
    slab(y_, dy_, m.half_y);
  }
  LUCERNA_HD void slab(V o, V d, double half) {
    const V a = (V(-half) - o) / d, b = (V(half) - o) / d;
    const Mask moves = (d < V(0.0)) | (V(0.0) < d);
    t_ = select(moves, max(min(a, b), t_), t_);
    t_end_ = select(moves, min(max(a, b), t_end_), t_end_);
    t_end_ = select(~moves & (V(half) < abs(o)), V(-1.0), t_end_);
  }

  /// q is above the band of s between `rise` and `fall`; before `reach` and beyond `low` the ray is below it.
  LUCERNA_HD void find_band(const HitMirror<Table>& m) {
    const V above = c0_ - V(m.high), root = c1_ * c1_ + V(4.0) * c2_ * above;
    const V w = sqrt(max(root, V(0.0)));
    const Mask up = V(0.0) < c1_, crosses = V(0.0) < root;
    const V far = (c1_ + w) / (V(2.0) * c2_), back = (c1_ - w) / (V(2.0) * c2_);
    rise_ = select(crosses, select(up, V(-2.0) * above / (c1_ + w), back), V(0.0));
    fall_ = select(crosses, select(up, far, V(2.0) * above / (w - c1_)), V(-1.0));
    const V over_low = c0_ - V(m.low), low_root = c1_ * c1_ + V(4.0) * c2_ * over_low;
    const V low_w = sqrt(max(low_root, V(0.0)));
    // Without a base c2 is next to nothing: the root is taken where no digits are lost.
    const V low = select(up, (c1_ + low_w) / (V(2.0) * c2_), V(2.0) * over_low / (low_w - c1_));
    low_ = select(V(0.0) < low_root, low, V(-1.0));
    const Mask from_below = up & (over_low < V(0.0)) & (V(0.0) < low_root);
    reach_ = select(from_below, V(-2.0) * over_low / (c1_ + low_w), V(0.0));
  }

  /// From behind a ray comes into the air only through the surface, which may touch the top of the band.
  LUCERNA_HD void skip_air(Mask searching) {
    const Mask behind = side_ < V(0.0);
    const Mask air = searching & ~behind & ~is(only_one_) & (rise_ <= t_) & (t_ < fall_);
    side_ = select(air, V(1.0), side_);
    t_ = select(air, fall_, t_);
    const Mask below = searching & ~is(side_) & ~is(only_one_) & (t_ < reach_);
    side_ = select(below, V(-1.0), side_);
    t_ = select(below, reach_, t_);
  }

  /// f and f' of this place; the first look tells the side.
  LUCERNA_HD void take(const HitLook<V>& look) {
    V f = c0_ + t_ * (c1_ - t_ * c2_) - look.s;
    const V df = c1_ - V(2.0) * t_ * c2_ - (look.sx * dx_ + look.sy * dy_);
    const Mask first = abs(side_) < V(0.5);
    side_ = select(first, select(f < V(0.0), V(-1.0), V(1.0)), side_);
    f = f * side_;
    f_ = select(is(only_one_), f, max(f, V(0.0)));
    df_ = df * side_;
  }

  /// Lanes that have arrived at the surface, or at its end; those that go through the hole go on.
  LUCERNA_HD Mask touch(const HitMirror<Table>& m, Mask ended) {
    const Mask arrived = (abs(f_) <= V(kTouch_mm)) & (df_ < V(0.0)) & ~ended;
    if (!any(arrived)) return arrived;
    const V t = t_ - f_ / df_;
    const V x = x_ + t * dx_, y = y_ + t * dy_;
    const Mask past = t_end_ < t, in_hole = x * x + y * y < V(m.hole * m.hole);
    const Mask hit = arrived & ~past & ~in_hole, through = arrived & ~past & in_hole;
    const V face =
        select(V(0.0) < side_, V(static_cast<double>(kHitFront)), V(static_cast<double>(kHitBack)));
    what_ = select(hit, face, what_);
    t_ = select(hit | through, t, t_);
    side_ = select(through, V(0.0) - side_, side_);
    df_ = select(through, V(0.0) - df_, df_);
    f_ = select(through, V(0.0), f_);
    only_one_ = select(through, V(0.0), only_one_);
    return arrived & ~through;
  }

  /// Positive root of f + df t - a t^2.
  LUCERNA_HD static V zero_ahead(V f, V df, V a) {
    const V w = sqrt(max(df * df + V(4.0) * a * f, V(0.0)));
    const Mask up = V(0.0) < df;
    return select(up, df + w, V(2.0) * f) / select(up, V(2.0) * a, w - df);
  }

  /// The longest step that the bounds allow.
  LUCERNA_HD V step_length(const HitMirror<Table>& m, const HitLook<V>& look) {
    const V half = V(0.5) * across_, whole = c2_ + V(m.curvature) * half;
    const Mask front = V(0.0) < side_;
    const V behind = select(front, V(0.0), V(2.0) * c2_);  // there the base bends the other way
    // On a stretch as long as `good`, |f''| is at most twice `max`.
    V good = V(static_cast<double>(near_cells(0))) * cell_t_, bound = c2_ + look.near[0] * half;
    // As far as the other side of the band f falls, if it does here and cannot bend enough to rise again.
    const V to_side = select(front, low_, rise_) - t_;
    const V bends = select(to_side < good, bound, whole) - select(front, V(2.0) * c2_, V(0.0));
    const V falls = max(V(2.0) * bends, V(0.0));
    const Mask only = (df_ < V(0.0)) & (V(0.0) < to_side) & (df_ + falls * to_side < V(0.0));
    only_one_ = select(only, V(1.0), only_one_);
    const Mask one = is(only_one_);
    V ahead = zero_ahead(f_, df_, c2_ - behind);
    if (!any(~one)) return ahead;
    V longest = V(0.0);
    for (int size = 0; size <= kNearSizes; ++size) {
      const V zero = zero_ahead(f_, df_, max(bound - behind, V(1e-30)));
      longest = max(min(good, zero), longest);
      if (!any(good < zero)) break;
      const bool last = size + 1 >= kNearSizes;
      good = last ? V(__builtin_inf()) : V(static_cast<double>(near_cells(size + 1))) * cell_t_;
      bound = last ? whole : c2_ + look.near[last ? 0 : size + 1] * half;
    }
    return select(one, ahead, longest);
  }

  V x_, y_, dx_, dy_, across_, c0_, c1_, c2_, cell_t_, rise_, fall_, reach_, low_, t_end_;
  V t_, side_;  ///< side: +1 in front of the mirror, -1 behind it, 0 not known yet
  V only_one_;  ///< f falls from here to its only zero: plain steps may overshoot
  V f_, df_, looks_, what_;
};

/// Searches of a whole batch: lanes whose search has ended take the next rays, half a vector at a time.
template <class V, class Table>
void search_hits(const HitMirror<Table>& mirror, const HitRays& rays, size_t n, HitEnds& ends) {
  static_assert(V::kLanes <= kHitPadding);
  const double* const from[8] = {rays.x,  rays.y,  rays.z,         rays.dx,
                                 rays.dy, rays.dz, rays.on_mirror, rays.slope};
  HitSearch<V, Table> search, fresh;
  V field[8];
  for (V& v : field) v = V(0.0);
  search.begin(mirror, field, field + 3, field[6], field[7]);
  size_t next = 0, ray[V::kLanes] = {};
  uint32_t busy = 0;
  constexpr uint32_t kAll = (1u << V::kLanes) - 1;
  while (next < n || busy != 0) {
    if (next < n && 2 * __builtin_popcount(busy) <= static_cast<int>(V::kLanes)) {
      uint32_t taken = 0;
      const auto idle = V::mask_of(~busy & kAll);
      for (int k = 0; k < 8; ++k) field[k] = expand(idle, from[k] + next, field[k]);
      for (uint32_t left = ~busy & kAll; left != 0 && next < n; left &= left - 1) {
        ray[__builtin_ctz(left)] = next++;
        taken |= left & (0u - left);
      }
      const uint32_t over = bits(fresh.begin(mirror, field, field + 3, field[6], field[7])) & taken;
      for (uint32_t left = taken & ~over; left != 0; left &= left - 1) {
        ends.what[ray[__builtin_ctz(left)]] = kHitNothing;
      }
      search.replace(V::mask_of(over), fresh);
      busy |= over;
      continue;
    }
    const uint32_t ended = bits(search.step(mirror)) & busy;
    busy &= ~ended;
    if (ended == 0) continue;
    double what[V::kLanes], t[V::kLanes];
    store(what, search.what());
    store(t, search.t());
    for (uint32_t left = ended; left != 0; left &= left - 1) {
      const int lane = __builtin_ctz(left);
      ends.what[ray[lane]] = static_cast<int32_t>(what[lane]);
      ends.t[ray[lane]] = t[lane];
    }
  }
}

}  // namespace lucerna
