// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "lucerna/optics/shapes/smooth_view.h"

namespace lucerna {

/// z = (x^2 + y^2) / (4 f) + bicubic B-spline on a uniform grid of knots over a rectangle. Coefficients row
/// by row: iy * row_x.coefficients() + ix. Beyond the rectangle its end polynomials continue. Immutable.
class BsplineShape {
 public:
  BsplineShape(double focal_mm, KnotRow row_x, KnotRow row_y, std::vector<double> coefficients);

  double focal_mm() const { return focal_mm_; }
  const KnotRow& row_x() const { return x_; }
  const KnotRow& row_y() const { return y_; }
  const std::vector<double>& coefficients() const { return c_; }

  /// The offset lies in this range everywhere on the rectangle (convex hull of the coefficients).
  const HeightRange& band() const { return band_; }
  /// Bound on the offset's second derivative along any unit direction of the xy plane.
  double curvature_bound() const { return curvature_bound_; }
  /// The same within near_cells(size) cells of each cell of knots: cells row by row x kNearSizes.
  const std::vector<double>& near_curvatures() const { return near_curvatures_; }

  BsplineView view() const {
    return {focal_mm_, x_, y_, c_.data(), band_, curvature_bound_, near_curvatures_.data()};
  }

 private:
  double focal_mm_;
  KnotRow x_, y_;
  std::vector<double> c_;
  HeightRange band_;
  double curvature_bound_ = 0.0;
  std::vector<double> near_curvatures_;
};

/// z = r^2 / (4 f) + cubic B-spline of r on uniform knots over [0, r_max], mirrored at the axis, so that the
/// surface has continuous curvature everywhere. The coefficient before the axis equals the one after it.
/// Immutable.
class RevolutionShape {
 public:
  /// `row` starts at 0; `coefficients` has row.coefficients() entries with [0] = [2].
  RevolutionShape(double focal_mm, KnotRow row, std::vector<double> coefficients);

  double focal_mm() const { return focal_mm_; }
  const KnotRow& row() const { return row_; }
  const std::vector<double>& coefficients() const { return c_; }
  const HeightRange& band() const { return band_; }
  double curvature_bound() const { return curvature_bound_; }
  const std::vector<double>& near_curvatures() const { return near_curvatures_; }

  RevolutionView view() const {
    return {focal_mm_, row_, c_.data(), band_, curvature_bound_, near_curvatures_.data()};
  }

 private:
  double focal_mm_;
  KnotRow row_;
  std::vector<double> c_;
  HeightRange band_;
  double curvature_bound_ = 0.0;
  std::vector<double> near_curvatures_;
};

/// A smooth shape as tracers and exporters see a surface.
template <class Shape>
class SmoothSurface final : public HeightSurface {
 public:
  explicit SmoothSurface(Shape shape) : shape_(std::move(shape)) {}
  const Shape& shape() const { return shape_; }

  SurfacePoint at(double x, double y) const override { return smooth_point(shape_.view(), x, y); }

  /// Height at the middle, give or take slope and bend: |h - h0 - grad (p - p0)| <= bend |p - p0|^2 / 2.
  HeightRange range(const Rectangle& r) const override {
    const double x = 0.5 * (r.x0_mm + r.x1_mm), y = 0.5 * (r.y0_mm + r.y1_mm);
    const double a = 0.5 * (r.x1_mm - r.x0_mm), b = 0.5 * (r.y1_mm - r.y0_mm);
    const SurfacePoint p = at(x, y);
    const double second = shape_.curvature_bound() + 0.5 / shape_.focal_mm();
    const double reach = std::abs(p.dzdx) * a + std::abs(p.dzdy) * b + 0.5 * second * (a * a + b * b);
    return {p.z_mm - reach, p.z_mm + reach};
  }

 private:
  Shape shape_;
};

}  // namespace lucerna
