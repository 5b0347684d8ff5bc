// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "lucerna/optics/height_field/field_hierarchy.h"
#include "lucerna/reflector.h"

namespace lucerna {

/// z = c0 + cx x + cy y + cxx x^2 + cxy x y + cyy y^2. Kept in float so that kernels and builders use the
/// same numbers.
struct Quadric {
  float c0 = 0.0F, cx = 0.0F, cy = 0.0F, cxx = 0.0F, cxy = 0.0F, cyy = 0.0F;

  SurfacePoint at(double x, double y) const {
    const double a = cxx, b = cxy, c = cyy, p = cx, q = cy;
    return {static_cast<double>(c0) + x * (p + a * x + b * y) + y * (q + c * y), p + 2.0 * a * x + b * y,
            q + b * x + 2.0 * c * y};
  }
};

/// A reflector sampled on a grid of cells x cells over its aperture's rectangle, for the fast tracers. What
/// is between the vertices is a C0 surface of cubic pieces with the vertices' heights and gradients (Adini's
/// rectangle, 12 numbers a cell): heights are exact to the fourth order of the cell, gradients to the third.
/// Everything is kept over one least-squares quadric, so that float32 is enough and a ray's quadratic roots
/// say where a hit is possible at all. Above it stands a quadtree of plane slabs that ends at squares of 8 x
/// 8 cells. Memory: 12 bytes a vertex and 16 / 64 * 4 / 3 bytes a cell. Immutable but for `rebuild`; reading
/// is thread safe.
class HeightField {
 public:
  /// Cells per side of a leaf square.
  static constexpr int kBlock = kFieldBlock;

  /// Samples `reflector`; `cells` a side, a power of two from 8 to 8192. Cost: cells^2 evaluations of the
  /// surface.
  HeightField(const Reflector& reflector, int cells);

  int cells() const { return cells_; }
  const Rectangle& region() const { return region_; }
  const Aperture& aperture() const { return aperture_; }
  const Quadric& quadric() const { return quadric_; }
  float step_x_mm() const { return step_x_mm_; }
  float step_y_mm() const { return step_y_mm_; }

  /// Row after row, (cells + 1)^2.
  const std::vector<FieldVertex>& vertices() const { return vertices_; }
  std::vector<FieldVertex>& vertices() { return vertices_; }
  /// All levels one after the other, leaves (level 0) first; row after row.
  const std::vector<FieldNode>& nodes() const { return nodes_; }
  /// Index of the first node of each level; the last level has one node.
  const std::vector<std::int32_t>& level_offsets() const { return offsets_; }
  /// By leaf square, row after row.
  const std::vector<LeafKind>& leaf_kinds() const { return leaf_kinds_; }
  /// Height over the quadric lies in [low, high] wherever the mirror is.
  const HeightRange& band() const { return band_; }
  /// The gradient of the height over the quadric is nowhere longer within rim_mm() of the axis.
  float gradient_bound() const { return gradient_bound_; }
  /// Every cell of the mirror ends within this distance of the axis.
  double rim_mm() const {
    return 1.0001 * aperture_.outer_radius_mm() + static_cast<double>(step_x_mm_ + step_y_mm_);
  }

  /// Makes nodes, band and gradient bound again after `vertices()` changed. Same bits for any number of
  /// threads. O(cells^2).
  void rebuild();

  /// The surface of cubic pieces at (x, y), clamped to the region: what the fast tracers hit.
  SurfacePoint at(double x_mm, double y_mm) const;

 private:
  void fit_quadric(const HeightSurface& surface);
  void sample(const HeightSurface& surface);

  Aperture aperture_;
  int cells_;
  Rectangle region_;
  float step_x_mm_, step_y_mm_;
  Quadric quadric_;
  std::vector<FieldVertex> vertices_;
  std::vector<FieldNode> nodes_;
  std::vector<LeafKind> leaf_kinds_;
  std::vector<std::int32_t> offsets_;
  HeightRange band_;
  float gradient_bound_ = 0.0F;
};

}  // namespace lucerna
