// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "lucerna/reflector/cubic_basis.h"
#include "lucerna/reflector/height_surface.h"

namespace lucerna {

/// How far a surface is off its base paraboloid at one place, and how steeply.
struct ShapeOffset {
  double s = 0.0, sx = 0.0, sy = 0.0;
};

/// What the derivative of a ray's path needs of a surface at one place: first and second derivatives of the
/// height, and of the coefficients the four (per direction) that count.
template <int kDirections>
struct ShapeLocal {
  double hx = 0.0, hy = 0.0, hxx = 0.0, hxy = 0.0, hyy = 0.0;
  std::array<int, kDirections> first{};
  std::array<CubicBasis, kDirections> basis{}, slope{};
  /// d(coordinate)/dx and /dy of the spline's argument, for revolution.
  double along_x = 0.0, along_y = 0.0;
};

/// z = (x^2 + y^2) / (4 f) + bicubic B-spline on a uniform grid of knots over a rectangle. Coefficients row
/// by row: iy * row_x.coefficients() + ix. Beyond the rectangle its end polynomials continue. Immutable.
class BsplineShape {
 public:
  static constexpr int kSupport = 16;
  using Local = ShapeLocal<2>;

  BsplineShape(double focal_mm, KnotRow row_x, KnotRow row_y, std::vector<double> coefficients);

  double focal_mm() const { return focal_mm_; }
  const KnotRow& row_x() const { return x_; }
  const KnotRow& row_y() const { return y_; }
  const std::vector<double>& coefficients() const { return c_; }

  /// The offset lies in this range everywhere on the rectangle (convex hull of the coefficients).
  const HeightRange& band() const { return band_; }
  /// Bound on the offset's second derivative along any unit direction of the xy plane.
  double bend_bound() const { return bend_bound_; }

  ShapeOffset offset(double x, double y) const;
  Local local(double x, double y) const;

  /// out[k] = alpha * d h / d c_k + beta * d h_x / d c_k + gamma * d h_y / d c_k for the kSupport
  /// coefficients at `local`.
  void gradient(const Local& local, double alpha, double beta, double gamma, double* out) const {
    for (std::size_t j = 0; j < 4; ++j) {
      const double b = local.basis[1][j];
      const double value = alpha * b + gamma * local.slope[1][j], slope = beta * b;
      for (std::size_t i = 0; i < 4; ++i) {
        out[4 * j + i] = value * local.basis[0][i] + slope * local.slope[0][i];
      }
    }
  }
  /// row[coefficient k] += a * u[k] + b * v[k] for the kSupport coefficients at `local`.
  void add(const Local& local, double a, const double* u, double b, const double* v, double* row) const {
    for (int j = 0; j < 4; ++j) {
      double* r = row + (local.first[1] + j) * x_.coefficients() + local.first[0];
      for (int i = 0; i < 4; ++i) r[i] += a * u[4 * j + i] + b * v[4 * j + i];
    }
  }

 private:
  double focal_mm_;
  KnotRow x_, y_;
  std::vector<double> c_;
  HeightRange band_;
  double bend_bound_ = 0.0;
};

/// z = r^2 / (4 f) + cubic B-spline of r on uniform knots over [0, r_max], mirrored at the axis, so that the
/// surface has continuous curvature everywhere. The coefficient before the axis equals the one after it.
/// Immutable.
class RevolutionShape {
 public:
  static constexpr int kSupport = 4;
  using Local = ShapeLocal<1>;

  /// `row` starts at 0; `coefficients` has row.coefficients() entries with [0] = [2].
  RevolutionShape(double focal_mm, KnotRow row, std::vector<double> coefficients);

  double focal_mm() const { return focal_mm_; }
  const KnotRow& row() const { return row_; }
  const std::vector<double>& coefficients() const { return c_; }
  const HeightRange& band() const { return band_; }
  double bend_bound() const { return bend_bound_; }

  /// Offset from the base paraboloid at a radius, and its slope.
  std::array<double, 2> offset_at(double r) const {
    const KnotRow::Place p = row_.place(r);
    const CubicBasis b = cubic_basis(p.t), d = cubic_basis_slope(p.t);
    const double* c = c_.data() + p.first;
    return {b[0] * c[0] + b[1] * c[1] + b[2] * c[2] + b[3] * c[3],
            (d[0] * c[0] + d[1] * c[1] + d[2] * c[2] + d[3] * c[3]) / row_.step_mm};
  }
  ShapeOffset offset(double x, double y) const {
    const double r = std::sqrt(x * x + y * y);
    const auto [s, slope] = offset_at(r);
    const double per_r = r > 0.0 ? slope / r : 0.0;
    return {s, x * per_r, y * per_r};
  }
  Local local(double x, double y) const;

  void gradient(const Local& local, double alpha, double beta, double gamma, double* out) const {
    const double slope = beta * local.along_x + gamma * local.along_y;
    for (std::size_t k = 0; k < 4; ++k) out[k] = alpha * local.basis[0][k] + slope * local.slope[0][k];
  }
  void add(const Local& local, double a, const double* u, double b, const double* v, double* row) const {
    double* r = row + local.first[0];
    for (int k = 0; k < 4; ++k) r[k] += a * u[k] + b * v[k];
  }

 private:
  double focal_mm_;
  KnotRow row_;
  std::vector<double> c_;
  HeightRange band_;
  double bend_bound_ = 0.0;
};

/// Height and gradient of a smooth shape.
template <class Shape>
SurfacePoint smooth_point(const Shape& shape, double x, double y) {
  const double k = 0.25 / shape.focal_mm();
  const ShapeOffset o = shape.offset(x, y);
  return {k * (x * x + y * y) + o.s, 2.0 * k * x + o.sx, 2.0 * k * y + o.sy};
}

/// A smooth shape as tracers and exporters see a surface.
template <class Shape>
class SmoothSurface final : public HeightSurface {
 public:
  explicit SmoothSurface(Shape shape) : shape_(std::move(shape)) {}
  const Shape& shape() const { return shape_; }

  SurfacePoint at(double x, double y) const override { return smooth_point(shape_, x, y); }

  /// Height at the middle, give or take slope and bend: |h - h0 - grad (p - p0)| <= bend |p - p0|^2 / 2.
  HeightRange range(const Rectangle& r) const override {
    const double x = 0.5 * (r.x0_mm + r.x1_mm), y = 0.5 * (r.y0_mm + r.y1_mm);
    const double a = 0.5 * (r.x1_mm - r.x0_mm), b = 0.5 * (r.y1_mm - r.y0_mm);
    const SurfacePoint p = at(x, y);
    const double bend = shape_.bend_bound() + 0.5 / shape_.focal_mm();
    const double reach = std::abs(p.dzdx) * a + std::abs(p.dzdy) * b + 0.5 * bend * (a * a + b * b);
    return {p.z_mm - reach, p.z_mm + reach};
  }

 private:
  Shape shape_;
};

}  // namespace lucerna
