// SPDX-License-Identifier: Apache-2.0
#pragma once

// The kernels of solid_kernels.h for any vector of doubles. Included only by the solid_kernels*.cpp files,
// after the vector; see simd_double.h for what they may use. Each function follows one of solid_kernel.h or
// revolved_kernel.h operation by operation.

#include "lucerna/simd/lane_vector.h"
#include "lucerna/trace/kernels/solid_kernels.h"

namespace lucerna {
namespace {

/// As RevolvedRay has them; in whole rows of four, which vectors gather.
struct RevolvedRow {
  double ox, oy, oz, dx;
  double dy, dz, a, b;
  double c, spin, unused[2];
};

// Written where they are kept: numbers that were just written one by one are slow to copy.
inline void set_row(const SolidBatch& batch, size_t i, RevolvedRow& r) {
  r.ox = batch.ox[i], r.oy = batch.oy[i], r.oz = batch.oz[i];
  r.dx = batch.dx[i], r.dy = batch.dy[i], r.dz = batch.dz[i];
  r.a = r.dx * r.dx + r.dy * r.dy;
  r.b = r.ox * r.dx + r.oy * r.dy;
  r.c = r.ox * r.ox + r.oy * r.oy;
  r.spin = r.ox * r.dy - r.oy * r.dx;
}

/// A ray as rings are tested with it, in float; it is counted from its point that is nearest to the centre,
/// so that its numbers are no larger than the body.
struct RingRay {
  float inverse_dz, z_over_dz, a, two_b, c, nearest, t_min, t_max;
  bool rises;
};

inline void set_ring_ray(const RevolvedRow& r, const RevolvedBlocks& blocks, double t_min, double t_max,
                         RingRay& out) {
  const double z = r.oz - blocks.centre_z, reach = blocks.reach;
  const double t0 = -(r.b + z * r.dz);
  const double at_x = r.ox + t0 * r.dx, at_y = r.oy + t0 * r.dy, at_z = z + t0 * r.dz;
  const double b = at_x * r.dx + at_y * r.dy;
  const double inverse_dz = 1.0 / (__builtin_fabs(r.dz) < 1e-15 ? 1e-15 : r.dz);
  out.rises = inverse_dz > 0.0;
  out.inverse_dz = static_cast<float>(inverse_dz);
  out.z_over_dz = static_cast<float>(at_z * inverse_dz);
  out.a = static_cast<float>(r.a);
  out.two_b = static_cast<float>(2.0 * b);
  out.c = static_cast<float>(at_x * at_x + at_y * at_y);
  out.nearest = static_cast<float>(-b / (r.a > 1e-15 ? r.a : 1e-15));
  // Beyond the ball there is nothing.
  const double from = t_min - t0, to = t_max - t0, slack = 1e-6 * reach;
  out.t_min = static_cast<float>((from > -reach ? from : -reach) - slack);
  out.t_max = static_cast<float>((to < reach ? to : reach) + slack);
}

/// Bits of the rings of a block that a ray may be in: as RevolvedRay::misses.
inline uint32_t rings_met(const RingRay& ray, const RingBlock& block) {
  alignas(32) int32_t met[kRingBlock];
  const float *const near = ray.rises ? block.z_low : block.z_high, *const far = ray.rises ? block.z_high
                                                                                           : block.z_low;
  for (int k = 0; k < kRingBlock; ++k) {
    const float in = fused(near[k], ray.inverse_dz, -ray.z_over_dz);
    const float out = fused(far[k], ray.inverse_dz, -ray.z_over_dz);
    const float from = in > ray.t_min ? in : ray.t_min, to = out < ray.t_max ? out : ray.t_max;
    const float late = ray.nearest > from ? ray.nearest : from, at = late < to ? late : to;
    const float r2 = fused(fused(ray.a, at, ray.two_b), at, ray.c);
    const float r2_from = fused(fused(ray.a, from, ray.two_b), from, ray.c);
    const float r2_to = fused(fused(ray.a, to, ray.two_b), to, ray.c);
    const float r2_most = r2_from > r2_to ? r2_from : r2_to;
    met[k] = ((from <= to) & (r2 <= block.r2_high[k]) & (block.r2_low[k] <= r2_most)) ? -1 : 0;
  }
  return signs_of_eight(met);
}

/// One root of a side's quadratic, as meet_side_at.
template <class Lanes>
struct SideRoot {
  typename Lanes::Mask met;
  Lanes t, share;
};

/// As intersect_side, of a vector of rays and sides; beyond all numbers where they do not meet.
template <class Lanes>
void meet_sides(const RevolvedRow* rows, const int32_t* ray, const RevolvedSide* sides, const int32_t* side,
                Lanes t_min, double* t_out, double* share_out) {
  constexpr int32_t kRowDoubles = sizeof(RevolvedRow) / sizeof(double);
  constexpr int32_t kSideDoubles = sizeof(RevolvedSide) / sizeof(double);
  int32_t row_at[Lanes::kLanes], side_at[Lanes::kLanes];
  for (unsigned k = 0; k < Lanes::kLanes; ++k) {
    row_at[k] = ray[k] * kRowDoubles;
    side_at[k] = side[k] * kSideDoubles;
  }
  Lanes ro[4], rd[4], rc[4], line[4], cone[4];
  gather4(&rows->ox, row_at, ro);
  gather4(&rows->dy, row_at, rd);
  gather4(&rows->c, row_at, rc);
  gather4(&sides->r, side_at, line);
  gather4(&sides->nr, side_at, cone);
  const LaneVector<Lanes> o{ro[0], ro[1], ro[2]}, d{ro[3], rd[0], rd[1]};
  const Lanes nr = cone[0], nz = cone[1], offset = cone[2], zero(0.0);

  const Lanes w = offset - nz * o.z, g = nz * d.z;
  const Lanes vx = w * d.x + g * o.x, vy = w * d.y + g * o.y;
  const Lanes spread = vx * vx + vy * vy - (nr * nr) * (rc[1] * rc[1]);
  const Lanes root = abs(nr) * sqrt(spread);
  const Lanes a = nr * nr * rd[2] - g * g, b = nr * nr * rd[3] + g * w, c = nr * nr * rc[0] - w * w;
  const Lanes q = select(b < zero, root - b, zero - b - root);

  const auto root_at = [&](Lanes t) {
    const Lanes x = o.x + t * d.x, y = o.y + t * d.y, z = o.z + t * d.z;
    const Lanes share = (sqrt(x * x + y * y) - line[0]) * line[2] + (z - line[1]) * line[3];
    const Lanes border(kSideBorder);
    const auto beside = (nr * (w - g * t) < zero) | (share < zero - border) | (Lanes(1.0) + border < share);
    return SideRoot<Lanes>{(zero <= spread) & (t_min < t) & ~beside, t, share};
  };
  const SideRoot<Lanes> first = root_at(q / a), second = root_at(c / q);
  const Lanes t = select(first.met, first.t, Lanes(__builtin_inf()));
  const auto later = second.met & (second.t < t);
  store(t_out, select(later, second.t, t));
  store(share_out, select(later, second.share, first.share));
}

/// The numbers of the bits of a byte that are set, one behind the other.
struct PackedBits {
  uint8_t of[256][kRingBlock];
  constexpr PackedBits() : of() {
    for (unsigned byte = 0; byte < 256; ++byte) {
      unsigned n = 0;
      for (unsigned k = 0; k < kRingBlock; ++k) {
        if ((byte >> k & 1U) != 0) of[byte][n++] = static_cast<uint8_t>(k);
      }
    }
  }
};
inline constexpr PackedBits kPackedBits;

/// Rays and what they may meet, added without a branch.
class RingPairs {
 public:
  static constexpr size_t kSize = 512, kRoom = kSize + kRingBlock;
  size_t size() const { return size_; }
  bool is_full() const { return size_ > kSize - kRingBlock; }
  void clear() { size_ = 0; }
  /// The bits of `met`, which stand for numbers from `first` on.
  void add(int32_t ray, uint32_t met, int32_t first) {
    for (size_t k = 0; k < kRingBlock; ++k) rays[size_ + k] = ray;
    for (size_t k = 0; k < kRingBlock; ++k) numbers[size_ + k] = first + kPackedBits.of[met][k];
    size_ += static_cast<size_t>(__builtin_popcount(met));
  }
  /// The pairs of a vector that begins before the last and ends behind it.
  void pad() {
    for (size_t i = size_; i < size_ + kRingBlock; ++i) rays[i] = numbers[i] = 0;
  }

  int32_t rays[kRoom], numbers[kRoom];

 private:
  size_t size_ = 0;
};

/// The first sides that rays meet. Rays and rings that may meet are collected level by level, then rays and
/// sides, then all of them meet: no step branches by what it finds, which a processor could not predict.
template <class Lanes>
class SideSearch {
 public:
  SideSearch(const RevolvedBlocks& table, double t_min, SolidBatch& batch)
      : table_(table), t_min_(t_min), batch_(batch) {}

  void search(size_t n) {
    for (size_t r = 0; r < n; ++r) {
      set_row(batch_, r, rows_[r]);
      set_ring_ray(rows_[r], table_, t_min_, batch_.t[r], rays_[r]);
      batch_.part[r] = -1;
      batch_.u[r] = 0.0;
    }
    const int32_t top = table_.level_count;
    const uint32_t blocks = table_.top_blocks > 1 ? 3 : 1;
    for (size_t r = 0; r < n; ++r) pairs_[top].add(static_cast<int32_t>(r), blocks, 0);
    for (int32_t level = top; level > 0; --level) resolve_rings(level);
    resolve_sides();
  }

 private:
  /// Finds what rays meet in the blocks of the level below. All are tested before any is added to a list: a
  /// processor would not read on before it knows where it writes.
  void resolve_rings(int32_t level) {
    RingPairs& blocks = pairs_[level];
    RingPairs& rings = pairs_[level - 1];
    uint8_t met[RingPairs::kRoom];
    for (size_t i = 0; i < blocks.size(); ++i)
      met[i] =
          static_cast<uint8_t>(rings_met(rays_[blocks.rays[i]], table_.levels[level - 1][blocks.numbers[i]]));
    for (size_t i = 0; i < blocks.size(); ++i) {
      if (rings.is_full()) resolve(level - 1);
      rings.add(blocks.rays[i], met[i], blocks.numbers[i] * kRingBlock);
    }
    blocks.clear();
  }
  void resolve(int32_t level) {
    if (level > 0) {
      resolve_rings(level);
    } else {
      resolve_sides();
    }
  }

  /// Moves rays to what they meet before all else.
  void resolve_sides() {
    RingPairs& sides = pairs_[0];
    alignas(64) double t[RingPairs::kRoom], share[RingPairs::kRoom];
    sides.pad();
    for (size_t i = 0; i < sides.size(); i += Lanes::kLanes)
      meet_sides<Lanes>(rows_, sides.rays + i, table_.sides, sides.numbers + i, t_min_, t + i, share + i);
    for (size_t i = 0; i < sides.size(); ++i) {
      const int32_t ray = sides.rays[i];
      const bool nearer = t[i] < batch_.t[ray];
      batch_.t[ray] = nearer ? t[i] : batch_.t[ray];
      batch_.u[ray] = nearer ? share[i] : batch_.u[ray];
      batch_.part[ray] = nearer ? sides.numbers[i] : batch_.part[ray];
    }
    sides.clear();
  }

  const RevolvedBlocks& table_;
  double t_min_;
  SolidBatch& batch_;
  RevolvedRow rows_[kSolidBatch];
  RingRay rays_[kSolidBatch];
  /// With blocks of each level, and with sides at its beginning.
  RingPairs pairs_[kMostLevels + 1];
};

template <class Lanes>
void first_sides(const RevolvedBlocks& blocks, double t_min, size_t n, SolidBatch& batch) {
  SideSearch<Lanes>(blocks, t_min, batch).search(n);
}

template <class Lanes>
LaneVector<Lanes> ray_ends(const SolidBatch& b, size_t i) {
  return LaneVector<Lanes>::load(b.ox + i, b.oy + i, b.oz + i) +
         Lanes::load(b.t + i) * LaneVector<Lanes>::load(b.dx + i, b.dy + i, b.dz + i);
}

/// As turned_normal.
template <class Lanes>
LaneVector<Lanes> turned_normal(Lanes nr, Lanes nz, const LaneVector<Lanes>& point, Lanes r) {
  const auto off_axis = Lanes(0.0) < r;
  return {select(off_axis, nr * point.x / r, nr), select(off_axis, nr * point.y / r, Lanes(0.0)), nz};
}

/// As cone_normal and curve_normal.
template <class Lanes>
void side_normals(const RevolvedSide* sides, size_t n, SolidBatch& batch) {
  constexpr int32_t kSideDoubles = sizeof(RevolvedSide) / sizeof(double);
  for (size_t i = 0; i < n; i += Lanes::kLanes) {
    int32_t at[Lanes::kLanes] = {};
    for (size_t k = 0; k < Lanes::kLanes && i + k < n; ++k)
      at[k] = batch.part[i + k] < 0 ? 0 : batch.part[i + k] * kSideDoubles;
    Lanes cone[4], ends[4];
    gather4(&sides->nr, at, cone);
    gather4(&sides->from_nr, at, ends);
    const LaneVector<Lanes> point = ray_ends<Lanes>(batch, i);
    const Lanes r = sqrt(point.x * point.x + point.y * point.y), share = Lanes::load(batch.u + i);
    turned_normal(cone[0], cone[1], point, r).store_to(batch.nx + i, batch.ny + i, batch.nz + i);
    turned_normal(ends[0] + share * (ends[2] - ends[0]), ends[1] + share * (ends[3] - ends[1]), point, r)
        .store_to(batch.sx + i, batch.sy + i, batch.sz + i);
  }
}

/// As Boundary.
template <class Lanes>
struct BoundaryLanes {
  Lanes s, p, cos_refracted;

  BoundaryLanes(Lanes of_s, Lanes of_p, Lanes c) : s(of_s), p(of_p), cos_refracted(c) {}
  BoundaryLanes(const BoundaryLanes& a) : s(a.s), p(a.p), cos_refracted(a.cos_refracted) {}
};

/// As boundary.
template <class Lanes>
BoundaryLanes<Lanes> boundary(Lanes ratio, Lanes cos_incidence) {
  const Lanes zero(0.0), one(1.0);
  const Lanes c = select(cos_incidence < one, cos_incidence, one);
  const Lanes squared = one - (one - c * c) / (ratio * ratio);
  const Lanes t = sqrt(squared);
  const auto passes = (zero < squared) & (zero < c), none = (ratio <= one) & (one <= ratio);
  const Lanes s = select(passes, (c - ratio * t) / (c + ratio * t), one);
  const Lanes p = select(passes, (ratio * c - t) / (ratio * c + t), one);
  return {select(none, zero, s), select(none, zero, p), select(none, c, select(passes, t, zero))};
}

/// As refracted.
template <class Lanes>
LaneVector<Lanes> refracted(const LaneVector<Lanes>& d, const LaneVector<Lanes>& normal, Lanes ratio,
                            const BoundaryLanes<Lanes>& found) {
  const Lanes c = Lanes(0.0) - dot(d, normal);
  return (Lanes(1.0) / ratio) * d + (c / ratio - found.cos_refracted) * normal;
}

template <class Lanes>
LaneVector<Lanes> mirrored(const LaneVector<Lanes>& d, const LaneVector<Lanes>& normal) {
  return d - (Lanes(2.0) * dot(d, normal)) * normal;
}

template <class Lanes>
LaneVector<Lanes> opposite(typename Lanes::Mask m, const LaneVector<Lanes>& a) {
  return select(m, Lanes(-1.0) * a, a);
}

/// As BoundaryHit, with the refracted ray.
template <class Lanes>
struct BoundaryHitLanes {
  LaneVector<Lanes> normal, refracted;
  BoundaryLanes<Lanes> found;
};

/// As boundary_hit.
template <class Lanes>
BoundaryHitLanes<Lanes> boundary_hit(const LaneVector<Lanes>& d, const LaneVector<Lanes>& outward,
                                     const LaneVector<Lanes>& smooth, Lanes ratio) {
  const Lanes zero(0.0);
  LaneVector<Lanes> face = unit(outward);
  face = opposite(zero < dot(face, d), face);
  const Lanes blend = sqrt(dot(smooth, smooth));
  LaneVector<Lanes> curve = smooth / blend;
  curve = opposite(dot(curve, face) < zero, curve);
  const auto same_side = (zero < blend) & (dot(curve, d) < zero) & (zero < dot(mirrored(d, curve), face));
  const LaneVector<Lanes> normal = select(same_side, curve, face);
  const BoundaryLanes<Lanes> found = boundary(ratio, zero - dot(d, normal));
  const LaneVector<Lanes> beyond = refracted(d, normal, ratio, found);
  const auto fine =
      (dot(beyond, face) < zero) | ((found.cos_refracted <= zero) & (zero <= found.cos_refracted));
  if (bits(~fine) == 0) return {normal, beyond, found};
  const BoundaryLanes<Lanes> own = boundary(ratio, zero - dot(d, face));
  return {select(fine, normal, face),
          select(fine, beyond, refracted(d, face, ratio, own)),
          {select(fine, found.s, own.s), select(fine, found.p, own.p),
           select(fine, found.cos_refracted, own.cos_refracted)}};
}

/// Light as cross_boundary leaves it.
template <class Lanes>
struct CrossedLanes {
  LaneVector<Lanes> direction, field;
  typename Lanes::Mask reflected;
};

/// As cross_boundary.
template <class Lanes>
CrossedLanes<Lanes> cross_boundary(const LaneVector<Lanes>& d, const LaneVector<Lanes>& field,
                                   const BoundaryHitLanes<Lanes>& at, Lanes ratio, Lanes u) {
  const BoundaryLanes<Lanes>& b = at.found;
  const Lanes zero(0.0), one(1.0);
  const LaneVector<Lanes> across = cross(d, at.normal);
  const LaneVector<Lanes> s = select(Lanes(1e-24) < dot(across, across), unit(across), field);
  const Lanes of_s = dot(field, s), of_p = dot(field, cross(d, s));
  const Lanes all = of_s * of_s + of_p * of_p, reflected_s = of_s * b.s, reflected_p = of_p * b.p;
  const auto reflected = u * all < reflected_s * reflected_s + reflected_p * reflected_p;
  const LaneVector<Lanes> out = unit(select(reflected, mirrored(d, at.normal), at.refracted));
  const Lanes on_s = select(reflected, reflected_s, of_s * (one + b.s));
  const Lanes on_p = select(reflected, reflected_p, of_p * (one + b.p) / ratio);
  const LaneVector<Lanes> after = on_s * s + on_p * cross(out, s);
  const Lanes size = sqrt(dot(after, after));
  return {out, select(zero < size, after / size, s), reflected};
}

/// As any_field, for light that meets a body; also says where it is within.
template <class Lanes>
void enter_solid(size_t n, SolidBatch& batch) {
  using Vector = LaneVector<Lanes>;
  const Lanes zero(0.0), one(1.0);
  for (size_t i = 0; i < n; i += Lanes::kLanes) {
    const Vector d = Vector::load(batch.dx + i, batch.dy + i, batch.dz + i);
    const Vector outward = Vector::load(batch.nx + i, batch.ny + i, batch.nz + i);
    const Vector s = cross(d, unit(outward));
    const Vector axis = select(abs(d.x) < Lanes(0.5), Vector(one, zero, zero), Vector(zero, one, zero));
    const Vector first = unit(select(Lanes(1e-24) < dot(s, s), s, cross(d, axis)));
    select(Lanes::load(batch.chance + i) < Lanes(0.5), first, cross(d, first))
        .store_to(batch.fx + i, batch.fy + i, batch.fz + i);
    store(batch.inside + i, select(zero < dot(outward, d), one, zero));
  }
}

template <class Lanes>
void cross_boundaries(size_t n, SolidBatch& batch) {
  const Lanes zero(0.0), one(1.0);
  for (size_t i = 0; i < n; i += Lanes::kLanes) {
    using Vector = LaneVector<Lanes>;
    const Vector d = Vector::load(batch.dx + i, batch.dy + i, batch.dz + i);
    const Vector field = Vector::load(batch.fx + i, batch.fy + i, batch.fz + i);
    const Vector outward = Vector::load(batch.nx + i, batch.ny + i, batch.nz + i);
    const Vector smooth = Vector::load(batch.sx + i, batch.sy + i, batch.sz + i);
    const Lanes ratio = Lanes::load(batch.ratio + i);
    const auto out = zero < dot(outward, d), inside = zero < Lanes::load(batch.inside + i);
    const auto behind = (out & ~inside) | (inside & ~out);
    const BoundaryHitLanes<Lanes> at = boundary_hit(d, outward, smooth, ratio);
    const CrossedLanes<Lanes> light = cross_boundary(d, field, at, ratio, Lanes::load(batch.chance + i));
    ray_ends<Lanes>(batch, i).store_to(batch.ox + i, batch.oy + i, batch.oz + i);
    select(behind, d, light.direction).store_to(batch.dx + i, batch.dy + i, batch.dz + i);
    select(behind, field, light.field).store_to(batch.fx + i, batch.fy + i, batch.fz + i);
    at.normal.store_to(batch.hx + i, batch.hy + i, batch.hz + i);
    store(batch.reflected + i, select(light.reflected, one, zero));
    store(batch.behind + i, select(behind, one, zero));
  }
}

}  // namespace
}  // namespace lucerna
