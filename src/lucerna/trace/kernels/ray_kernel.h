// SPDX-License-Identifier: Apache-2.0
#pragma once

// Rays kLanes at a time: in a mirror's frame and back, reflected, and the Type C cells that they leave to.
// Included by the kernel_*.cpp files and by what runs on a GPU, see simd_float.h.

#include "lucerna/simd/simd_float.h"
#include "lucerna/trace/kernels/kernel.h"

namespace lucerna {
namespace {

/// kLanes rays in a mirror's frame, and where they meet it (LocalRays, LocalHits).
struct LaneRays {
  Float x, y, z, dx, dy, dz;
  Mask on_mirror;
};
struct LaneHits {
  Float past, gx, gy;
  Int state;
  Float gz = 1.0f;  ///< always, of height fields
  Float start = 0.0f;
  LUCERNA_HD Float t() const { return start + past; }
};

inline LaneRays load_rays(const LocalRays& rays, size_t i) {
  return {load(rays.x + i),
          load(rays.y + i),
          load(rays.z + i),
          load(rays.dx + i),
          load(rays.dy + i),
          load(rays.dz + i),
          load(rays.on_mirror + i) == Int(1)};
}

/// Start and direction in another frame; `on_mirror` stays.
LUCERNA_HD inline LaneRays in_frame(const FrameView& k, const LaneRays& r) {
  return {k.m[0] * r.x + k.m[1] * r.y + k.m[2] * r.z + k.v[0],
          k.m[3] * r.x + k.m[4] * r.y + k.m[5] * r.z + k.v[1],
          k.m[6] * r.x + k.m[7] * r.y + k.m[8] * r.z + k.v[2],
          k.m[0] * r.dx + k.m[1] * r.dy + k.m[2] * r.dz,
          k.m[3] * r.dx + k.m[4] * r.dy + k.m[5] * r.dz,
          k.m[6] * r.dx + k.m[7] * r.dy + k.m[8] * r.dz,
          r.on_mirror};
}

inline void to_local(const FrameView& k, const WorldRays& in, size_t n, int32_t index, LocalRays& out) {
  for (size_t i = 0; i < n; i += static_cast<size_t>(kLanes)) {
    const LaneRays r = in_frame(k, {load(in.x + i), load(in.y + i), load(in.z + i), load(in.dx + i),
                                    load(in.dy + i), load(in.dz + i), load(in.mirror + i) == Int(index)});
    store(out.x + i, r.x);
    store(out.y + i, r.y);
    store(out.z + i, r.z);
    store(out.dx + i, r.dx);
    store(out.dy + i, r.dy);
    store(out.dz + i, r.dz);
    store(out.on_mirror + i, select(r.on_mirror, Int(1), Int(0)));
  }
}

/// Rays reflected where they hit, in the mirror's frame still; also the cosine of incidence.
LUCERNA_HD inline LaneRays reflected(const LaneRays& ray, const LaneHits& hit, Float& cosine) {
  // d . n times the length of n = (-gx, -gy, gz).
  const Float across = hit.gz * ray.dz - hit.gx * ray.dx - hit.gy * ray.dy;
  const Float n2 = hit.gz * hit.gz + hit.gx * hit.gx + hit.gy * hit.gy;
  const Float twice = 2.0f * across / n2;
  const Float rx = fma(twice, hit.gx, ray.dx), ry = fma(twice, hit.gy, ray.dy), rz = ray.dz - twice * hit.gz;
  const Float unit = Float(1.0f) / sqrt(rx * rx + ry * ry + rz * rz);
  cosine = abs(across) / sqrt(n2);
  return {fma(hit.past, ray.dx, fma(hit.start, ray.dx, ray.x)),
          fma(hit.past, ray.dy, fma(hit.start, ray.dy, ray.y)),
          fma(hit.past, ray.dz, fma(hit.start, ray.dz, ray.z)),
          rx * unit,
          ry * unit,
          rz * unit,
          ray.on_mirror};
}

inline void reflect_rays(const FrameView& k, const LocalRays& rays, const LocalHits& hits, size_t n,
                         WorldRays& out, float* cosine) {
  for (size_t i = 0; i < n; i += static_cast<size_t>(kLanes)) {
    const LaneHits hit{load(hits.past + i),  load(hits.gx + i), load(hits.gy + i),
                       load(hits.state + i), load(hits.gz + i), load(hits.start + i)};
    const Mask m = hit.state == Int(kFront);
    Float c;
    const LaneRays r = in_frame(k, reflected(load_rays(rays, i), hit, c));
    store(cosine + i, c);
    store(out.x + i, select(m, r.x, load(out.x + i)));
    store(out.y + i, select(m, r.y, load(out.y + i)));
    store(out.z + i, select(m, r.z, load(out.z + i)));
    store(out.dx + i, select(m, r.dx, load(out.dx + i)));
    store(out.dy + i, select(m, r.dy, load(out.dy + i)));
    store(out.dz + i, select(m, r.dz, load(out.dz + i)));
  }
}

/// atan2(y, x) as a share of a turn, [0, 1): a polynomial of degree 15 in the smaller over the larger, error
/// 6e-9 of a turn before rounding (coefficients: least squares at Chebyshev nodes, reweighted to a level
/// error).
LUCERNA_HD inline Float turn_of(Float y, Float x) {
  const Float ax = abs(x), ay = abs(y);
  const Float big = max(max(ax, ay), 1e-30f), q = min(ax, ay) / big, s = q * q;
  Float p = fma(s, -6.45253366e-04f, 3.47940825e-03f);
  p = fma(s, p, -8.89844209e-03f);
  p = fma(s, p, 1.53458219e-02f);
  p = fma(s, p, -2.21361863e-02f);
  p = fma(s, p, 3.17459277e-02f);
  p = fma(s, p, -5.30461194e-02f);
  p = fma(s, p, 1.59154837e-01f);
  p = p * q;
  p = select(ax < ay, Float(0.25f) - p, p);
  p = select(x < Float(0.0f), Float(0.5f) - p, p);
  return select(y < Float(0.0f), Float(1.0f) - p, p);
}

/// Type C cells of directions, as FarFieldGrid::cell has them.
LUCERNA_HD inline Int far_field_cell(Float dx, Float dy, Float dz, int32_t c_count, int32_t gamma_count) {
  const Float around = turn_of(dy, dx), from_nadir = turn_of(sqrt(dx * dx + dy * dy), Float(0.0f) - dz);
  const Int c = truncate(fma(around, Float(static_cast<float>(c_count)), 0.5f));
  const Int g = truncate(fma(from_nadir, Float(2.0f * static_cast<float>(gamma_count - 1)), 0.5f));
  const Int inside = select(c < Int(c_count), c, Int(0));
  return max(inside, Int(0)) * Int(gamma_count) + max(min(g, Int(gamma_count - 1)), Int(0));
}

inline void far_field_cells(const WorldRays& rays, size_t n, int32_t c_count, int32_t gamma_count,
                            int32_t* cell) {
  for (size_t i = 0; i < n; i += static_cast<size_t>(kLanes)) {
    store(cell + i,
          far_field_cell(load(rays.dx + i), load(rays.dy + i), load(rays.dz + i), c_count, gamma_count));
  }
}

}  // namespace
}  // namespace lucerna
