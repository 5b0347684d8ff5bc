// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/optics/shapes/smooth_view.h"
#include "lucerna/reflector.h"
#include "lucerna/simd/scalar_double.h"
#include "lucerna/trace/kernels/first_hit.h"

namespace lucerna {

// The smooth families as the searches of first_hit.h read them, and that search for one ray.

LUCERNA_HD inline HitRow hit_row(const KnotRow& row) {
  return {row.start_mm, 1.0 / row.step_mm, row.intervals};
}
LUCERNA_HD inline BsplineHitTable hit_table(const BsplineView& s) {
  return {hit_row(s.row_x), hit_row(s.row_y), s.coefficients, s.near_curvatures};
}
LUCERNA_HD inline RevolutionHitTable hit_table(const RevolutionView& s) {
  return {hit_row(s.row), s.coefficients, s.near_curvatures};
}

/// A mirror of one of the families. Points into the view's coefficients.
template <class Shape>
LUCERNA_HD auto hit_mirror(const Shape& shape, const Aperture& a) {
  using Table = decltype(hit_table(shape));
  return HitMirror<Table>{hit_table(shape),
                          0.25 / shape.focal_mm,
                          shape.band.low_mm,
                          shape.band.high_mm,
                          shape.curvature_bound,
                          shape.cell_mm(),
                          a.shape() == ApertureShape::circle,
                          a.half_x_mm(),
                          a.half_y_mm(),
                          a.hole_radius_mm()};
}

/// How the search of one ray ends (kHitNothing, ...), and where.
struct HitEnd {
  std::int32_t what = kHitNothing;
  double t_mm = 0.0;
};

/// Of a ray from `o` along the unit vector `d`. `slope` is f' where it starts on the mirror's front.
template <class Table>
LUCERNA_HD HitEnd search_first(const HitMirror<Table>& mirror, const Vec3& o, const Vec3& d, bool on_mirror,
                               double slope) {
  HitSearch<ScalarDouble, Table> search;
  const ScalarDouble from[3] = {o.x, o.y, o.z}, along[3] = {d.x, d.y, d.z};
  if (!search.begin(mirror, from, along, on_mirror ? 1.0 : 0.0, slope).m) return {};
  while (!search.step(mirror).m) {
  }
  return {static_cast<std::int32_t>(search.what().v), search.t().v};
}

}  // namespace lucerna
