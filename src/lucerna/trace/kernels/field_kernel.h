// SPDX-License-Identifier: Apache-2.0
#pragma once

// The first hit of rays with a HeightField, kLanes rays at a time (docs/theory/height-fields.md).
// Included by the kernel_*.cpp files and by what runs on a GPU, see simd_float.h.

#include "lucerna/trace/kernels/ray_kernel.h"

namespace lucerna {
namespace {

inline constexpr float kFar = 1e18f;
/// A ray that is farther from a mirror's box than this passes it.
inline constexpr float kFarStart = 1e12f;

/// A component that is nearly 0 counts as a tiny positive one; its sign is the reciprocal's everywhere.
inline constexpr float kNoDirection = 1e-20f;

/// What a ray must fall or rise faster than the surface: the rounding of both slopes, many times over.
inline constexpr float kSlopeTolerance = 1e-4f;
/// Of a falling ray: guesses by the planes of leaf squares, and the most steps on the surface itself before
/// it is sent down the tree like any other.
inline constexpr int kPlaneGuesses = 2, kMaxDescents = 6;

/// 1 / d. A ray that runs along a grid line belongs to the cells towards the middle of the grid, `inward` of
/// it: so it is in the grid on its borders too.
LUCERNA_HD inline Float reciprocal_of(Float d, Float inward) {
  const Float none = select(inward < Float(0.0f), Float(0.0f) - kNoDirection, kNoDirection);
  return Float(1.0f) / select(abs(d) < Float(kNoDirection), none, d);
}

/// Both roots of a t^2 + b t + c = 0 with a < 0, in order; none where the discriminant is below 0.
struct Roots {
  Float low, high;
  Mask exist;
};
LUCERNA_HD inline Roots roots(Float a, Float b, Float c) {
  const Float disc = fma(b, b, Float(-4.0f) * a * c);
  const Float root = sqrt(max(disc, 0.0f));
  Float w = Float(-0.5f) * select(b < Float(0.0f), b - root, b + root);
  w = select(abs(w) < Float(1e-30f), 1e-30f, w);
  const Float r = w / a, s = c / w;
  return {min(r, s), max(r, s), Float(0.0f) <= disc};
}

/// kLanes rays on their way through one field.
class Packet {
 public:
  Packet() = default;
  LUCERNA_HD Packet(const FieldView& field, const LaneRays& rays) { set(field, rays); }

  LUCERNA_HD void set(const FieldView& field, const LaneRays& rays) {
    field_ = &field;
    ox_ = rays.x;
    oy_ = rays.y;
    oz_ = rays.z;
    dx_ = rays.dx;
    dy_ = rays.dy;
    dz_ = rays.dz;
    on_mirror_ = rays.on_mirror;
  }

  /// First hits of `lanes`; the others miss.
  LUCERNA_HD LaneHits run(Mask lanes) {
    begin(lanes);
    return finish();
  }

  /// The part of `run` that needs little of the surface, and asks memory for what `finish` will read first.
  LUCERNA_HD void begin(Mask lanes) {
    hit_state_ = Int(kMiss);
    hit_t_ = kFar;
    hit_gx_ = hit_gy_ = 0.0f;
    prepare(lanes);
  }

  LUCERNA_HD LaneHits finish() {
    while (any(descending_ | node_ | leaf_ | bracketed_)) {
      if (any(descending_)) descend();
      while (any(node_)) node_step();
      while (any(leaf_)) leaf_step();
      // Lanes that cross the surface wait here for the others: Newton's steps then serve all at once.
      if (!any(node_) && any(bracketed_)) refine();
    }
    return {hit_t_, hit_gx_, hit_gy_, hit_state_, 1.0f, shift_};
  }

 private:
  /// A place of the surface, over the quadric.
  struct Piece {
    Float z, gx, gy;
  };
  /// Adini's piece of one cell (HeightField), over the quadric.
  struct Cell {
    Float z00, z10, z01, z11, p00, p10, p01, p11, q00, q10, q01, q11;
  };

  /// Height of the ray over the quadric at distance t.
  LUCERNA_HD Float height_over(Float t) const { return fma(fma(u2_, t, u1_), t, u0_); }
  /// How fast that grows.
  LUCERNA_HD Float slope_over(Float t) const { return fma(2.0f * u2_, t, u1_); }
  LUCERNA_HD Float middle() const { return 0.5f * (field_->low + field_->high); }
  LUCERNA_HD Float half() const { return 0.5f * (field_->high - field_->low); }

  LUCERNA_HD void prepare(Mask lanes) {
    idx_ = reciprocal_of(dx_, 0.5f * (field_->x0 + field_->x1) - ox_);
    idy_ = reciprocal_of(dy_, 0.5f * (field_->y0 + field_->y1) - oy_);
    // Along a border 0 times infinity would be anything.
    const Float mx = select(abs(dx_) < Float(kNoDirection), 1e-6f * (field_->x1 - field_->x0), 0.0f);
    const Float my = select(abs(dy_) < Float(kNoDirection), 1e-6f * (field_->y1 - field_->y0), 0.0f);
    const Float ax = (Float(field_->x0) - mx - ox_) * idx_, bx = (Float(field_->x1) + mx - ox_) * idx_;
    const Float ay = (Float(field_->y0) - my - oy_) * idy_, by = (Float(field_->y1) + my - oy_) * idy_;
    const Float over_region = max(min(ax, bx), min(ay, by));
    start_at_the_box(over_region);
    Float t0 = max(over_region - shift_, 0.0f);
    // A little past the region, so that its last border is crossed like any other.
    Float t1 = fma(min(min(max(ax, bx), max(ay, by)) - shift_, kFar), 1.00001f, 1e-4f);
    if (field_->round) cut_to_rim(t0, t1);
    u0_ = oz_ - field_->q0 - ox_ * (Float(field_->qx) + field_->qxx * ox_ + field_->qxy * oy_) -
          oy_ * (Float(field_->qy) + field_->qyy * oy_);
    u1_ = dz_ - dx_ * (Float(field_->qx) + 2.0f * field_->qxx * ox_ + field_->qxy * oy_) -
          dy_ * (Float(field_->qy) + field_->qxy * ox_ + 2.0f * field_->qyy * oy_);
    u2_ = Float(0.0f) - (field_->qxx * dx_ * dx_ + field_->qxy * dx_ * dy_ + field_->qyy * dy_ * dy_);
    // Where the ray is inside the band: on a concave parabola between its upper roots and its lower ones; an
    // upward one is turned over.
    const Mask up = Float(0.0f) < u2_;
    const Float sign = select(up, -1.0f, 1.0f);
    const Float a = min(sign * u2_, -1e-30f), b = sign * u1_, c = sign * u0_;
    const Float high = half() + field_->tolerance + sign * middle(),
                low = Float(0.0f) - half() - field_->tolerance + sign * middle();
    const Roots upper = roots(a, b, c - high), lower = roots(a, b, c - low);
    const Float first_end = select(upper.exist, upper.low, lower.high);
    begin_ = max(lower.low, t0);
    end_ = select(lower.exist, min(first_end, t1), -1.0f);
    next_begin_ = max(upper.high, t0);
    next_end_ = select(upper.exist & lower.exist, min(lower.high, t1), -1.0f);
    node_ = leaf_ = bracketed_ = descending_ = mask_of(0);
    max_slope_ = field_->gradient_bound * sqrt(dx_ * dx_ + dy_ * dy_) + kSlopeTolerance;
    // What was just reflected and rises faster than any of the surface does not come back in this interval.
    const Mask rising =
        on_mirror_ & (begin_ <= Float(0.0f)) & (max_slope_ < min(slope_over(begin_), slope_over(end_)));
    end_ = select(rising, -1.0f, end_);
    start(lanes);
  }

  /// Narrows t0 .. t1 to where the ray is over the disc of a round mirror; nothing is left if it passes
  /// beside.
  LUCERNA_HD void cut_to_rim(Float& t0, Float& t1) const {
    const Float a = max(dx_ * dx_ + dy_ * dy_, 1e-12f), b = ox_ * dx_ + oy_ * dy_;
    const Float disc = fma(b, b, a * (Float(field_->rim * field_->rim) - ox_ * ox_ - oy_ * oy_));
    const Float root = sqrt(max(disc, 0.0f)), per_a = Float(1.0f) / a;
    t0 = max(t0, (Float(0.0f) - b - root) * per_a);
    t1 = select(Float(0.0f) <= disc, min(t1, (root - b) * per_a), -1.0f);
  }

  /// Moves starts along their rays to where these enter the box about the mirror, so that all that follows is
  /// rounded as numbers of the mirror's size are, from however far a ray may come.
  LUCERNA_HD void start_at_the_box(Float over_region) {
    const float z0 = field_->q0 - field_->reach + field_->low - field_->tolerance,
                z1 = field_->q0 + field_->reach + field_->high + field_->tolerance;
    const Float idz = reciprocal_of(dz_, 0.5f * (z0 + z1) - oz_);
    const Float enter = max(over_region, min((Float(z0) - oz_) * idz, (Float(z1) - oz_) * idz));
    shift_ = select((Float(0.0f) < enter) & (enter < Float(kFarStart)) & ~on_mirror_, enter, 0.0f);
    ox_ = fma(shift_, dx_, ox_);
    oy_ = fma(shift_, dy_, oy_);
    oz_ = fma(shift_, dz_, oz_);
  }

  /// Lanes of `m` begin their interval, or the next one if it is empty.
  LUCERNA_HD void start(Mask m) {
    const Mask empty = m & ~(begin_ < end_);
    begin_ = select(empty, next_begin_, begin_);
    end_ = select(empty, next_end_, end_);
    next_end_ = select(empty, -1.0f, next_end_);
    m = m & (begin_ < end_);
    // A ray that falls faster than any of the surface does hits it once or not at all.
    const Mask starts = on_mirror_ & (begin_ <= Float(0.0f));
    const Mask descends =
        m & ~starts & (max(slope_over(begin_), slope_over(end_)) < Float(0.0f) - max_slope_);
    if (any(descends)) guess(descends);
    if (any(m & ~descends)) walk(m & ~descends);
  }

  /// Sends the lanes of `m` down the tree from the beginning of their interval.
  LUCERNA_HD void walk(Mask m) {
    t_ = select(m, begin_, t_);
    const Float u = height_over(t_) - middle();
    // On which side of the surface the ray is: plain outside the band, else it must be looked up; a ray just
    // reflected is on the front.
    Float side = u;
    const Mask inside = m & (abs(u) < half() + 0.5f * field_->tolerance);
    const Mask reflected = on_mirror_ & (t_ <= Float(0.0f));
    if (any(inside & ~reflected)) {
      Int ix, iy;
      cell_at(t_, ix, iy);
      side = select(inside, height_over(t_) - surface(t_, ix, iy).z, side);
    }
    side_ = select(m, select(reflected | (Float(0.0f) <= side), 1.0f, -1.0f), side_);
    set_end(m);
    // First look at a square about as large as the interval is long.
    const Float length = end_ - t_;
    const Float squares =
        max(abs(dx_) * length * (0.125f / field_->step_x), abs(dy_) * length * (0.125f / field_->step_y));
    const Int exponent = shift_right(float_bits(min(max(squares, 1.0f), 65536.0f)), Int(23)) - Int(127);
    level_ = select(m, min(exponent, Int(field_->levels - 1)), level_);
    Int cx, cy;
    cell_at(t_, cx, cy);
    bx_ = select(m, shift_right(cx, Int(3)), bx_);
    by_ = select(m, shift_right(cy, Int(3)), by_);
    node_ = node_ | m;
  }

  /// Where the lanes of `m`, which fall, may hit the surface, by the planes of leaf squares.
  LUCERNA_HD void guess(Mask m) {
    Float t = 0.5f * (begin_ + end_);
    for (int i = 0; i < kPlaneGuesses; ++i) t = closer(t, leaf_plane(t));
    t_ = select(m, t, t_);
    descending_ = descending_ | m;
    Int ix, iy;
    cell_at(t, ix, iy);
    ask_for_cell(ix, iy, m);
  }

  /// Asks memory for a cell that will be read soon.
  LUCERNA_HD void ask_for_cell(Int ix, Int iy, Mask m) const {
    const Int row = Int((field_->blocks * 8 + 1) * 3), first = iy * row + ix * Int(3);
    prefetch(field_->vertices, first, m);
    prefetch(field_->vertices, first + row, m);
  }

  /// Settles the lanes of descending_: the ray's height over the surface falls all through the interval, so
  /// that Newton's method finds the only zero or that there is none.
  LUCERNA_HD void descend() {
    Float t = t_;
    Int ix, iy;
    cell_at(t, ix, iy);
    Cell k = cell(ix, iy);
    // Lanes stop one by one, each where it would alone: a ray's hit must not depend on its neighbours.
    Mask moving = descending_, converged = mask_of(0), none = mask_of(0);
    for (int i = 0; i < kMaxDescents && any(moving); ++i) {
      const Piece p = piece(k, t, ix, iy);
      const Float f = height_over(t) - p.z;
      const Mask close = abs(f) <= Float(field_->tolerance);
      const Mask apart = ((t <= begin_) & (f < Float(0.0f))) | ((end_ <= t) & (Float(0.0f) < f));
      converged = converged | (moving & close);
      none = none | (moving & apart & ~close);
      t = select(moving, closer(t, p), t);
      moving = moving & ~(converged | none);
      Int jx, jy;
      cell_at(t, jx, jy);
      const Mask elsewhere = moving & ~((ix == jx) & (iy == jy));
      if (!any(elsewhere)) continue;
      ix = select(elsewhere, jx, ix);
      iy = select(elsewhere, jy, iy);
      k = cell(ix, iy);
    }
    descending_ = mask_of(0);
    side_ = select(converged, 1.0f, side_);
    const Mask over_now = (converged & ~hit(converged, t, piece(k, t, ix, iy))) | none;
    end_ = select(over_now, -1.0f, end_);
    if (any(over_now)) start(over_now);
    if (any(moving)) walk(moving);
  }

  /// One of Newton's steps towards where the ray meets `p`, within the interval.
  LUCERNA_HD Float closer(Float t, const Piece& p) const {
    const Float f = height_over(t) - p.z, df = slope_over(t) - p.gx * dx_ - p.gy * dy_;
    return min(max(t - f / min(df, Float(0.0f) - kSlopeTolerance), begin_), end_);
  }

  /// The plane of the leaf square at t; none where that has no mirror.
  LUCERNA_HD Piece leaf_plane(Float t) const {
    Int ix, iy;
    cell_at(t, ix, iy);
    const Int bx = shift_right(ix, Int(3)), by = shift_right(iy, Int(3));
    Float a, b, c, e;
    gather4(field_->nodes, shift_left(by * Int(field_->blocks) + bx, Int(2)), a, b, c, e);
    const Float x = fma(to_float(shift_left(bx, Int(3)) + Int(4)), field_->step_x, field_->x0),
                y = fma(to_float(shift_left(by, Int(3)) + Int(4)), field_->step_y, field_->y0);
    return {fma(b, fma(t, dx_, ox_) - x, fma(c, fma(t, dy_, oy_) - y, a)), b, c};
  }

  /// Does the ray leave the band on the other side at the end of its interval?
  LUCERNA_HD void set_end(Mask m) {
    const Mask beyond =
        side_ * (height_over(end_) - middle()) < Float(0.0f) - half() - 0.5f * field_->tolerance;
    crosses_ = (crosses_ & ~m) | (beyond & m);
  }

  LUCERNA_HD void cell_at(Float t, Int& ix, Int& iy) const {
    const int32_t last = field_->blocks * 8 - 1;
    ix = min(max(truncate((fma(t, dx_, ox_) - field_->x0) * (1.0f / field_->step_x)), Int(0)), Int(last));
    iy = min(max(truncate((fma(t, dy_, oy_) - field_->y0) * (1.0f / field_->step_y)), Int(0)), Int(last));
  }

  LUCERNA_HD void node_step() {
    const Int last_square = Int(field_->blocks - 1);
    const Int nx = shift_right(min(max(bx_, Int(0)), last_square), level_);
    const Int ny = shift_right(min(max(by_, Int(0)), last_square), level_);
    const Int per_side = shift_right(Int(field_->blocks), level_);
    const Int node = shift_left(gather(field_->offsets, level_) + ny * per_side + nx, Int(2));
    Float a, b, c, e;
    gather4(field_->nodes, node, a, b, c, e);
    const Float scale = to_float(shift_left(Int(8), level_));
    const Float wx = scale * field_->step_x, wy = scale * field_->step_y;
    const Float xl = fma(to_float(nx), wx, field_->x0), yl = fma(to_float(ny), wy, field_->y0);
    const Mask right = Float(0.0f) < idx_, north = Float(0.0f) < idy_;
    const Float tx = (select(right, xl + wx, xl) - ox_) * idx_,
                ty = (select(north, yl + wy, yl) - oy_) * idy_;
    const Float te = max(min(min(tx, ty), end_), t_);
    const Float p0 = fma(b, ox_ - xl - 0.5f * wx, fma(c, oy_ - yl - 0.5f * wy, a)), p1 = fma(b, dx_, c * dy_);
    const Float k0 = side_ * (u0_ - p0), k1 = side_ * (u1_ - p1), k2 = side_ * u2_;
    const Float va = fma(fma(k2, t_, k1), t_, k0), vb = fma(fma(k2, te, k1), te, k0);
    // Within the step a parabola leaves its chord by a quarter of k2 times the step squared, on the side of
    // its sign.
    const Float length = te - t_, sag = 0.25f * k2 * length * length;
    const Float below = max(sag, 0.0f), above = max(Float(0.0f) - sag, 0.0f);
    const Float reach = e + field_->tolerance;
    const Mask skip = node_ & ((e < Float(0.0f)) | (reach < min(va, vb) - below));
    const Mask enter = node_ & ~skip;

    // Nearer: forward to where the ray can first touch the slab; at a leaf also back to where it is surely
    // through.
    const Float per_descent = length / max(va - vb, 1e-30f);
    const Mask ahead = enter & (reach < va - below);
    const Mask down = enter & (level_ == Int(0));
    const Mask through = down & (vb + above < Float(0.0f) - reach) & (vb < va);
    leaf_end_ = select(down, select(through, fma(va + above + reach, per_descent, t_), end_), leaf_end_);
    leaf_crosses_ = (leaf_crosses_ & ~down) | (down & (through | crosses_));
    t_ = select(ahead, min(fma(va - below - reach, per_descent, t_), te), t_);
    Int cx, cy;
    cell_at(t_, cx, cy);
    const Int last = shift_left(Int(1), level_) - Int(1);
    const Int fx = shift_left(nx, level_), fy = shift_left(ny, level_);
    bx_ = select(enter, min(max(shift_right(cx, Int(3)), fx), fx + last), bx_);
    by_ = select(enter, min(max(shift_right(cy, Int(3)), fy), fy + last), by_);
    ix_ = select(down, min(max(cx, shift_left(bx_, Int(3))), shift_left(bx_, Int(3)) + Int(7)), ix_);
    iy_ = select(down, min(max(cy, shift_left(by_, Int(3))), shift_left(by_, Int(3)) + Int(7)), iy_);
    leaf_ = leaf_ | down;
    node_ = node_ & ~down;
    if (any(down)) ask_for_cell(ix_, iy_, down);  // while other lanes still look for their leaf
    level_ = select(enter & ~down, level_ - Int(1), level_);
    // Where there is no mirror the ray may have gone through the surface unseen.
    const Mask unseen = skip & (e < Float(0.0f));
    if (any(unseen)) look_at_side(unseen, te);
    if (any(skip)) skip_node(skip, nx, ny, tx, ty, te);
  }

  /// On which side of the surface the lanes of `m` are at t.
  LUCERNA_HD void look_at_side(Mask m, Float t) {
    // Outside a round rim and on the way out, no ray hits the mirror again.
    const Float x = fma(t, dx_, ox_), y = fma(t, dy_, oy_);
    m = m & ((x * dx_ + y * dy_ < Float(0.0f)) | (x * x + y * y < Float(field_->half_x * field_->half_x)));
    if (!any(m)) return;
    Int ix, iy;
    cell_at(t, ix, iy);
    side_ = select(m, select(surface(t, ix, iy).z <= height_over(t), 1.0f, -1.0f), side_);
    set_end(m);
  }

  /// On to the square behind this one, a level up where that has another parent.
  LUCERNA_HD void skip_node(Mask skip, Int nx, Int ny, Float tx, Float ty, Float te) {
    t_ = select(skip, te, t_);
    Int cx, cy;
    cell_at(te, cx, cy);
    const Mask by_x = tx <= ty;
    const Int step_x = select(Float(0.0f) < idx_, Int(1), Int(-1)),
              step_y = select(Float(0.0f) < idy_, Int(1), Int(-1));
    const Int ex = nx + step_x, ey = ny + step_y;
    const Int last = shift_left(Int(1), level_) - Int(1);
    const Int fx = shift_left(nx, level_), fy = shift_left(ny, level_);
    const Int along_x = min(max(shift_right(cx, Int(3)), fx), fx + last),
              along_y = min(max(shift_right(cy, Int(3)), fy), fy + last);
    const Int enter_x = select(step_x == Int(1), shift_left(ex, level_), fx - Int(1));
    const Int enter_y = select(step_y == Int(1), shift_left(ey, level_), fy - Int(1));
    const Int new_x = select(by_x, enter_x, along_x), new_y = select(by_x, along_y, enter_y);
    bx_ = select(skip, new_x, bx_);
    by_ = select(skip, new_y, by_);
    const Mask same_x = shift_right(max(ex, Int(0)), Int(1)) == shift_right(nx, Int(1));
    const Mask same_y = shift_right(max(ey, Int(0)), Int(1)) == shift_right(ny, Int(1));
    const Mask same = (by_x & same_x) | (~by_x & same_y);
    level_ = select(skip & ~same, min(level_ + Int(1), Int(field_->levels - 1)), level_);
    finish_if_out(skip, te);
  }

  /// Lanes of `m` whose interval is over, or that left the grid, go to their next interval or stop.
  LUCERNA_HD void finish_if_out(Mask m, Float t) {
    const Mask outside =
        (bx_ < Int(0)) | (by_ < Int(0)) | (Int(field_->blocks - 1) < bx_) | (Int(field_->blocks - 1) < by_);
    const Mask height_over = m & (outside | (end_ <= t));
    if (!any(height_over)) return;
    node_ = node_ & ~height_over;
    leaf_ = leaf_ & ~height_over;
    end_ = select(height_over, -1.0f, end_);
    start(height_over);
  }

  LUCERNA_HD void leaf_step() {
    const Mask right = Float(0.0f) < idx_, north = Float(0.0f) < idy_;
    const Int gx = ix_ + select(right, Int(1), Int(0)), gy = iy_ + select(north, Int(1), Int(0));
    const Float tx = (fma(to_float(gx), field_->step_x, field_->x0) - ox_) * idx_;
    const Float ty = (fma(to_float(gy), field_->step_y, field_->y0) - oy_) * idy_;
    const Float exit = max(min(tx, ty), t_);
    const Mask by_x = tx <= ty;
    const Mask ends = leaf_ & (leaf_end_ <= exit);
    const Float segment = min(exit, leaf_end_);
    Mask cross = ends & leaf_crosses_;
    const Mask border = leaf_ & ~ends;
    if (any(border)) {
      const Float f = side_ * (height_over(segment) - border_height(segment, by_x, gx, gy));
      // A border lets a ray be under the surface by the tolerance, and so does a hit behind it: where a
      // reflected ray starts, twice as much is let through, or it would hit its start for ever.
      const Mask starts = on_mirror_ & (segment < Float(512.0f * field_->tolerance));
      cross =
          cross | (border & (f < Float(0.0f) - select(starts, 2.0f * field_->tolerance, field_->tolerance)));
    }
    const Mask over_now = ends & ~cross;
    const Mask go = border & ~cross;
    bracketed_ = bracketed_ | cross;
    leaf_ = leaf_ & ~cross;
    bracket_end_ = select(cross, segment, bracket_end_);
    t_ = select(go, segment, t_);
    ix_ = select(go & by_x, ix_ + select(right, Int(1), Int(-1)), ix_);
    iy_ = select(go & ~by_x, iy_ + select(north, Int(1), Int(-1)), iy_);
    if (any(go)) {  // what the next step reads, if it goes on along y
      const Int row = Int((field_->blocks * 8 + 1) * 3);
      prefetch(field_->vertices, (iy_ + select(north, Int(1), Int(0))) * row + ix_ * Int(3), go);
    }
    // Division by 8 that rounds down: one square before the first is -1.
    const Int nbx = shift_right(ix_ + Int(8), Int(3)) - Int(1),
              nby = shift_right(iy_ + Int(8), Int(3)) - Int(1);
    const Mask leaves = go & ~((nbx == bx_) & (nby == by_));
    if (any(leaves)) {
      bx_ = select(leaves, nbx, bx_);
      by_ = select(leaves, nby, by_);
      leaf_ = leaf_ & ~leaves;
      node_ = node_ | leaves;
      level_ = select(leaves, Int(0), level_);
      finish_if_out(leaves, t_);
    }
    if (any(over_now)) finish_if_out(over_now, kFar);
  }

  /// Height over the quadric where the ray crosses a grid line: a cubic between two vertices, the same for
  /// both cells.
  LUCERNA_HD Float border_height(Float t, Mask by_x, Int gx, Int gy) const {
    const Int per_row = Int(field_->blocks * 8 + 1);
    // Lanes that are done keep places off the grid and must read within it all the same.
    const Int last = Int(field_->blocks * 8 - 1), zero = Int(0), one = Int(1);
    const Int vx = min(max(select(by_x, gx, ix_), zero), select(by_x, last + one, last));
    const Int vy = min(max(select(by_x, iy_, gy), zero), select(by_x, last, last + one));
    const Int first = (vy * per_row + vx) * Int(3);
    const Int second = first + select(by_x, per_row * Int(3), Int(3));
    Float z0, z1, p0, p1, q0, q1;
    gather3(field_->vertices, first, z0, p0, q0);
    gather3(field_->vertices, second, z1, p1, q1);
    const Float g0 = select(by_x, q0 * field_->step_y, p0 * field_->step_x),
                g1 = select(by_x, q1 * field_->step_y, p1 * field_->step_x);
    const Float along =
        select(by_x, (fma(t, dy_, oy_) - field_->y0) * (1.0f / field_->step_y) - to_float(iy_),
               (fma(t, dx_, ox_) - field_->x0) * (1.0f / field_->step_x) - to_float(ix_));
    const Float u = min(max(along, 0.0f), 1.0f), w = Float(1.0f) - u;
    const Float chord = z1 - z0;
    return fma(u, chord, z0) + u * w * (w * (g0 - chord) - u * (g1 - chord));
  }

  LUCERNA_HD Cell cell(Int ix, Int iy) const {
    const int32_t row = (field_->blocks * 8 + 1) * 3;
    const float* const v = field_->vertices;
    // Two corners are six numbers in a row: z, p, q, z, and q, z, p, q of the same.
    const float* const rows[4] = {v, v + 2, v + row, v + row + 2};
    Float k[4][4];
    gather4(rows, iy * Int(row) + ix * Int(3), k);
    const Float sx = field_->step_x, sy = field_->step_y;
    return {k[0][0],      k[0][3],      k[2][0],      k[2][3],      sx * k[0][1], sx * k[1][2],
            sx * k[2][1], sx * k[3][2], sy * k[0][2], sy * k[1][3], sy * k[2][2], sy * k[3][3]};
  }
  LUCERNA_HD static void edge_deviation(Float u, Float a, Float b, Float& value, Float& slope) {
    const Float w = Float(1.0f) - u;
    value = u * w * (w * a - u * b);
    slope = w * (Float(1.0f) - 3.0f * u) * a - u * (Float(2.0f) - 3.0f * u) * b;
  }
  LUCERNA_HD Piece piece(const Cell& k, Float t, Int ix, Int iy) const {
    const Float u = (fma(t, dx_, ox_) - field_->x0) * (1.0f / field_->step_x) - to_float(ix);
    const Float v = (fma(t, dy_, oy_) - field_->y0) * (1.0f / field_->step_y) - to_float(iy);
    const Float um = Float(1.0f) - u, vm = Float(1.0f) - v;
    const Float south = k.z10 - k.z00, north = k.z11 - k.z01, west = k.z01 - k.z00, east = k.z11 - k.z10;
    Float s, ds, n, dn, w, dw, e, de;
    edge_deviation(u, k.p00 - south, k.p10 - south, s, ds);
    edge_deviation(u, k.p01 - north, k.p11 - north, n, dn);
    edge_deviation(v, k.q00 - west, k.q01 - west, w, dw);
    edge_deviation(v, k.q10 - east, k.q11 - east, e, de);
    return {vm * (k.z00 + u * south + s) + v * (k.z01 + u * north + n) + um * w + u * e,
            (vm * (south + ds) + v * (north + dn) - w + e) * (1.0f / field_->step_x),
            (um * (west + dw) + u * (east + de) - s + n) * (1.0f / field_->step_y)};
  }
  LUCERNA_HD Piece surface(Float t, Int ix, Int iy) const { return piece(cell(ix, iy), t, ix, iy); }

  /// The lanes of bracketed_ cross the surface between t_ and bracket_end_: finds where, by Newton's method
  /// in that bracket.
  LUCERNA_HD void refine() {
    const Mask m = bracketed_;
    const Float segment = bracket_end_;
    bracketed_ = mask_of(0);
    const Cell k = cell(min(max(ix_, Int(0)), Int(field_->blocks * 8 - 1)),
                        min(max(iy_, Int(0)), Int(field_->blocks * 8 - 1)));
    Float t = 0.5f * (t_ + segment);
    for (int i = 0; i < 3; ++i) {
      const Piece p = piece(k, t, ix_, iy_);
      const Float f = height_over(t) - p.z, df = fma(2.0f * u2_, t, u1_) - p.gx * dx_ - p.gy * dy_;
      t = min(max(t - f / select(abs(df) < Float(1e-20f), 1e-20f, df), t_), segment);
    }
    const Piece p = piece(k, t, ix_, iy_);
    const Mask there = hit(m, t, p);
    // Through the hole or past the rim: on, on the other side.
    const Mask on = m & ~there;
    if (!any(on)) return;
    leaf_ = leaf_ | on;
    t_ = select(on, segment, t_);
    side_ = select(on, Float(0.0f) - side_, side_);
    set_end(on);
    leaf_end_ = select(on, end_, leaf_end_);
    leaf_crosses_ = (leaf_crosses_ & ~on) | (crosses_ & on);
  }

  /// Notes that the lanes of `m` meet the surface at t, where it has a mirror; returns where that is.
  LUCERNA_HD Mask hit(Mask m, Float t, const Piece& p) {
    const Float x = fma(t, dx_, ox_), y = fma(t, dy_, oy_), r2 = x * x + y * y;
    const Mask in_round = r2 <= Float(field_->half_x * field_->half_x);
    const Mask in_box = (abs(x) <= Float(field_->half_x)) & (abs(y) <= Float(field_->half_y));
    const Mask there = m & (Float(field_->hole * field_->hole) <= r2) & (field_->round ? in_round : in_box);
    hit_t_ = select(there, t, hit_t_);
    hit_gx_ = select(there, Float(field_->qx) + 2.0f * field_->qxx * x + field_->qxy * y + p.gx, hit_gx_);
    hit_gy_ = select(there, Float(field_->qy) + field_->qxy * x + 2.0f * field_->qyy * y + p.gy, hit_gy_);
    hit_state_ = select(there, select(Float(0.0f) < side_, Int(kFront), Int(kBack)), hit_state_);
    return there;
  }

  const FieldView* field_;
  Float ox_, oy_, oz_, dx_, dy_, dz_, idx_, idy_, shift_;
  Float u0_, u1_, u2_;
  Float begin_, end_, next_begin_, next_end_;
  Float max_slope_;
  Float t_ = 0.0f, side_ = 1.0f, leaf_end_ = 0.0f, bracket_end_ = 0.0f;
  Int level_{0}, bx_{0}, by_{0}, ix_{0}, iy_{0};
  Mask on_mirror_, descending_, node_, leaf_, bracketed_, crosses_ = mask_of(0), leaf_crosses_ = mask_of(0);
  Float hit_t_, hit_gx_, hit_gy_;
  Int hit_state_;
};

inline void store_hits(const LaneHits& hit, size_t i, LocalHits& hits) {
  store(hits.t + i, hit.t());
  store(hits.start + i, hit.start);
  store(hits.past + i, hit.past);
  store(hits.gx + i, hit.gx);
  store(hits.gy + i, hit.gy);
  store(hits.gz + i, hit.gz);
  store(hits.state + i, hit.state);
}

/// Packets that are begun before the first is finished, while memory brings what they asked for.
inline constexpr size_t kGroup = 4;

inline void intersect(const FieldView& field, const LocalRays& rays, size_t n, LocalHits& hits) {
  constexpr size_t k = static_cast<size_t>(kLanes);
  static_assert(kBatch % (kGroup * k) == 0);
  for (size_t first = 0; first < n; first += kGroup * k) {
    Packet packets[kGroup];
    const size_t left = (n - first + k - 1) / k, count = left < kGroup ? left : kGroup;
    for (size_t p = 0; p < count; ++p) {
      const size_t i = first + p * k, lanes = n - i;
      packets[p].set(field, load_rays(rays, i));
      packets[p].begin(mask_of(lanes >= k ? (1u << k) - 1u : (1u << lanes) - 1u));
    }
    for (size_t p = 0; p < count; ++p) store_hits(packets[p].finish(), first + p * k, hits);
  }
}

}  // namespace
}  // namespace lucerna
