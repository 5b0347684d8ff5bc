// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cfloat>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lucerna/host_device.h"

namespace lucerna {

// How the tree of plane slabs over a HeightField is made, node by node: what CPU and GPU share when a
// mirror's shape has changed. Every node depends on vertices or on its four children alone, so the nodes of a
// level may be made in any order.

/// One grid vertex of a HeightField: height and gradient of the surface less those of the field's quadric.
struct FieldVertex {
  float z_mm = 0.0F, dzdx = 0.0F, dzdy = 0.0F;
};

/// A plane slab over a square of cells: |z - (a + b (x - cx) + c (y - cy))| <= e with (cx, cy) the square's
/// centre, z over the quadric. e < 0 where no part of the mirror is.
struct FieldNode {
  float a = 0.0F, b = 0.0F, c = 0.0F, e = -1.0F;
};

/// What a leaf square of cells has of the mirror: some, none but it lies in the hole or along the rim, where
/// rays come by on their way to it, or none and no ray that hits the mirror need come by (an aperture
/// without its hole is convex).
enum class LeafKind : std::uint8_t { beyond, mirror, bare };

/// The slab over a leaf square, and a bound on its gradient: nowhere longer than `gradient_bound`.
struct FieldLeaf {
  FieldNode slab;
  float gradient_bound = 0.0F;
};

/// Cells per side of a leaf square.
inline constexpr int kFieldBlock = 8;

namespace detail {
LUCERNA_HD inline float min(float a, float b) { return b < a ? b : a; }
LUCERNA_HD inline float max(float a, float b) { return a < b ? b : a; }

/// The vertices of one row of a leaf square: heights, and slopes times the cell's size.
struct FieldRow {
  float z[kFieldBlock + 1], p[kFieldBlock + 1], q[kFieldBlock + 1];

  LUCERNA_HD void read(const FieldVertex* v, float step_x_mm, float step_y_mm) {
    for (int i = 0; i <= kFieldBlock; ++i) {
      z[i] = v[i].z_mm;
      p[i] = v[i].dzdx * step_x_mm;
      q[i] = v[i].dzdy * step_y_mm;
    }
  }
};

/// The maximum of n, moved to the front.
LUCERNA_HD inline void max_first(float* x, std::size_t n) {
  for (std::size_t i = 1; i < n; ++i) x[0] = max(x[0], x[i]);
}
}  // namespace detail

// g++ unrolls loops of nine before it looks for vectors, and then finds none.
#if defined(__GNUC__) && !defined(__clang__) && !defined(__CUDACC__)
#define LUCERNA_KEEP_LOOP _Pragma("GCC unroll 1")
#else
#define LUCERNA_KEEP_LOOP
#endif

/// Leaf square (bx, by) of a grid of `cells` a side.
LUCERNA_HD inline FieldLeaf field_leaf(const FieldVertex* vertices, int cells, float step_x_mm,
                                       float step_y_mm, std::size_t bx, std::size_t by) {
  using detail::max, detail::min;
  constexpr std::size_t k = kFieldBlock;
  const std::size_t n = static_cast<std::size_t>(cells) + 1;
  const FieldVertex* const base = vertices + (by * k * n + bx * k);
  const FieldVertex &v00 = base[0], &v10 = base[k], &v01 = base[k * n], &v11 = base[k * n + k];
  const float dx = 0.5F * (v10.z_mm - v00.z_mm + v11.z_mm - v01.z_mm) / static_cast<float>(k);
  const float dy = 0.5F * (v01.z_mm - v00.z_mm + v11.z_mm - v10.z_mm) / static_cast<float>(k);
  // Heights over that plane, and how far a cell's edges can bend away from their chords: at most a quarter of
  // the maximum difference between a slope and the chord's, in each direction. By column, so that compilers
  // see vectors.
  float low[k + 1], high[k + 1], curvature_x[k], curvature_y[k + 1], slope_x[k + 1], slope_y[k + 1];
  for (std::size_t i = 0; i <= k; ++i) {
    low[i] = FLT_MAX;
    high[i] = -FLT_MAX;
    curvature_y[i] = slope_x[i] = slope_y[i] = 0.0F;
  }
  for (std::size_t i = 0; i < k; ++i) curvature_x[i] = 0.0F;
  detail::FieldRow rows[2];
  for (std::size_t j = 0; j <= k; ++j) {
    detail::FieldRow& row = rows[j % 2];
    row.read(base + j * n, step_x_mm, step_y_mm);
    LUCERNA_KEEP_LOOP
    for (std::size_t i = 0; i <= k; ++i) {
      const float r = row.z[i] - dx * static_cast<float>(i) - dy * static_cast<float>(j);
      low[i] = min(low[i], r);
      high[i] = max(high[i], r);
      slope_x[i] = max(slope_x[i], std::abs(row.p[i]));
      slope_y[i] = max(slope_y[i], std::abs(row.q[i]));
    }
    LUCERNA_KEEP_LOOP
    for (std::size_t i = 0; i < k; ++i) {
      const float chord = row.z[i + 1] - row.z[i];
      curvature_x[i] = max(curvature_x[i], max(std::abs(row.p[i] - chord), std::abs(row.p[i + 1] - chord)));
    }
    if (j == 0) continue;
    const detail::FieldRow& before = rows[1 - j % 2];
    LUCERNA_KEEP_LOOP
    for (std::size_t i = 0; i <= k; ++i) {
      const float chord = row.z[i] - before.z[i];
      curvature_y[i] = max(curvature_y[i], max(std::abs(before.q[i] - chord), std::abs(row.q[i] - chord)));
    }
  }
  for (std::size_t i = 1; i <= k; ++i) low[0] = min(low[0], low[i]);
  detail::max_first(high, k + 1);
  detail::max_first(curvature_x, k);
  detail::max_first(curvature_y, k + 1);
  detail::max_first(slope_x, k + 1);
  detail::max_first(slope_y, k + 1);
  const float half = 0.5F * static_cast<float>(k);
  // A hair more for the rounding of these sums.
  const float tolerance = 1e-6F * (std::abs(low[0]) + std::abs(high[0])) + FLT_MIN;
  // An edge is a cubic: its slope is within that of its ends and 3 chord - (both), which is at most thrice
  // the maximum bend steeper than an end. Across, the other edges' bends add their difference.
  const float gradient_x = (slope_x[0] + 3.0F * curvature_x[0] + 0.5F * curvature_y[0]) / step_x_mm;
  const float gradient_y = (slope_y[0] + 3.0F * curvature_y[0] + 0.5F * curvature_x[0]) / step_y_mm;
  return {{0.5F * (low[0] + high[0]) + half * (dx + dy), dx / step_x_mm, dy / step_y_mm,
           0.5F * (high[0] - low[0]) + 0.25F * (curvature_x[0] + curvature_y[0]) + tolerance},
          (1.0F + 1e-5F) * std::sqrt(gradient_x * gradient_x + gradient_y * gradient_y)};
}

#undef LUCERNA_KEEP_LOOP

/// The slab over square (ix, iy) of `level` > 0 from the four of the level below, whose nodes begin at
/// `children`; `n` of them a side.
LUCERNA_HD inline FieldNode field_parent(const FieldNode* children, std::size_t n, float step_x_mm,
                                         float step_y_mm, int level, std::size_t ix, std::size_t iy) {
  const FieldNode* const c[4] = {&children[2 * iy * n + 2 * ix], &children[2 * iy * n + 2 * ix + 1],
                                 &children[(2 * iy + 1) * n + 2 * ix],
                                 &children[(2 * iy + 1) * n + 2 * ix + 1]};
  FieldNode p{0.0F, 0.0F, 0.0F, -1.0F};
  float there = 0.0F;
  for (const FieldNode* const q : c) {
    if (q->e < 0.0F) continue;
    there += 1.0F;
    p.a += q->a;
    p.b += q->b;
    p.c += q->c;
  }
  if (there == 0.0F) return p;
  p.a /= there;
  p.b /= there;
  p.c /= there;
  // Half a child's size; the children's centres lie as far from the parent's.
  const float hx = 0.5F * step_x_mm * static_cast<float>(kFieldBlock << (level - 1));
  const float hy = 0.5F * step_y_mm * static_cast<float>(kFieldBlock << (level - 1));
  float low = FLT_MAX, high = -low;
  for (int i = 0; i < 4; ++i) {
    if (c[i]->e < 0.0F) continue;
    const float at_centre = c[i]->a - p.a - p.b * (i % 2 == 0 ? -hx : hx) - p.c * (i / 2 == 0 ? -hy : hy);
    const float tilt = std::abs(c[i]->b - p.b) * hx + std::abs(c[i]->c - p.c) * hy;
    low = detail::min(low, at_centre - tilt - c[i]->e);
    high = detail::max(high, at_centre + tilt + c[i]->e);
  }
  p.a += 0.5F * (low + high);
  p.e = 0.5F * (high - low) * (1.0F + 1e-6F) + 1e-6F * std::abs(p.a);
  return p;
}

/// How far the surface over a leaf may be from the height at its centre.
LUCERNA_HD inline float field_reach(const FieldNode& leaf, float step_x_mm, float step_y_mm) {
  const float hx = 0.5F * step_x_mm * kFieldBlock, hy = 0.5F * step_y_mm * kFieldBlock;
  return std::abs(leaf.b) * hx + std::abs(leaf.c) * hy + leaf.e;
}

}  // namespace lucerna
