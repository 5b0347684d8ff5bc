// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "lucerna/host_device.h"
#include "lucerna/optics/shapes/cubic_basis.h"
#include "lucerna/optics/shapes/near_cells.h"
#include "lucerna/reflector.h"

namespace lucerna {

// The smooth families as CPU and GPU read them: sizes, and a pointer to the coefficients, which must outlive
// the view.

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

/// BsplineShape's height and derivatives.
struct BsplineView {
  static constexpr int kSupport = 16;
  using Local = ShapeLocal<2>;

  double focal_mm = 1.0;
  KnotRow row_x, row_y;
  const double* coefficients = nullptr;
  /// The offset lies in this range everywhere on the rectangle (convex hull of the coefficients).
  HeightRange band;
  /// Bound on the offset's second derivative along any unit direction of the xy plane.
  double curvature_bound = 0.0;
  /// The same about each cell, row by row: within near_cells(0) cells of it, near_cells(1), ...
  const double* near_curvatures = nullptr;

  LUCERNA_HD const double* near_curvatures_at(double x, double y) const {
    const std::ptrdiff_t cell = row_y.place(y).first * std::ptrdiff_t{row_x.intervals} + row_x.place(x).first;
    return near_curvatures + kNearSizes * cell;
  }
  /// Least width of a cell.
  LUCERNA_HD double cell_mm() const { return row_x.step_mm < row_y.step_mm ? row_x.step_mm : row_y.step_mm; }

  LUCERNA_HD ShapeOffset offset(double x, double y) const {
    const KnotRow::Place px = row_x.place(x), py = row_y.place(y);
    const CubicBasis bx = cubic_basis(px.t), dx = cubic_basis_slope(px.t);
    const CubicBasis by = cubic_basis(py.t), dy = cubic_basis_slope(py.t);
    const int nx = row_x.coefficients();
    const double* c = coefficients + std::ptrdiff_t{py.first} * nx + px.first;
    ShapeOffset o;
    for (std::size_t j = 0; j < 4; ++j, c += nx) {
      const double value = bx[0] * c[0] + bx[1] * c[1] + bx[2] * c[2] + bx[3] * c[3];
      const double slope = dx[0] * c[0] + dx[1] * c[1] + dx[2] * c[2] + dx[3] * c[3];
      o.s += by[j] * value;
      o.sx += by[j] * slope;
      o.sy += dy[j] * value;
    }
    o.sx /= row_x.step_mm;
    o.sy /= row_y.step_mm;
    return o;
  }

  LUCERNA_HD Local local(double x, double y) const {
    const KnotRow::Place px = row_x.place(x), py = row_y.place(y);
    const CubicBasis bx = cubic_basis(px.t), dx = cubic_basis_slope(px.t), ex = cubic_basis_second(px.t);
    const CubicBasis by = cubic_basis(py.t), dy = cubic_basis_slope(py.t), ey = cubic_basis_second(py.t);
    const int nx = row_x.coefficients();
    const double* c = coefficients + std::ptrdiff_t{py.first} * nx + px.first;
    double sx = 0.0, sy = 0.0, sxx = 0.0, sxy = 0.0, syy = 0.0;
    for (std::size_t j = 0; j < 4; ++j, c += nx) {
      const double value = bx[0] * c[0] + bx[1] * c[1] + bx[2] * c[2] + bx[3] * c[3];
      const double slope = dx[0] * c[0] + dx[1] * c[1] + dx[2] * c[2] + dx[3] * c[3];
      const double bend = ex[0] * c[0] + ex[1] * c[1] + ex[2] * c[2] + ex[3] * c[3];
      sx += by[j] * slope;
      sy += dy[j] * value;
      sxx += by[j] * bend;
      sxy += dy[j] * slope;
      syy += ey[j] * value;
    }
    const double px1 = 1.0 / row_x.step_mm, py1 = 1.0 / row_y.step_mm, k = 0.5 / focal_mm;
    Local l;
    l.hx = k * x + sx * px1;
    l.hy = k * y + sy * py1;
    l.hxx = k + sxx * px1 * px1;
    l.hxy = sxy * px1 * py1;
    l.hyy = k + syy * py1 * py1;
    l.first = {px.first, py.first};
    l.basis = {bx, by};
    for (std::size_t i = 0; i < 4; ++i) {
      l.slope[0][i] = dx[i] * px1;
      l.slope[1][i] = dy[i] * py1;
    }
    return l;
  }

  /// out[k] = alpha * d h / d c_k + beta * d h_x / d c_k + gamma * d h_y / d c_k for the kSupport
  /// coefficients at `local`.
  LUCERNA_HD void gradient(const Local& local, double alpha, double beta, double gamma, double* out) const {
    for (std::size_t j = 0; j < 4; ++j) {
      const double b = local.basis[1][j];
      const double value = alpha * b + gamma * local.slope[1][j], slope = beta * b;
      for (std::size_t i = 0; i < 4; ++i) {
        out[4 * j + i] = value * local.basis[0][i] + slope * local.slope[0][i];
      }
    }
  }
  /// row.add(coefficient k, a * u[k] + b * v[k]) for the kSupport coefficients at `local`; or all at once,
  /// row.add(local.first, {...}), where a row takes blocks.
  template <class Row>
  LUCERNA_HD void add(const Local& local, double a, const double* u, double b, const double* v,
                      const Row& row) const {
    if constexpr (requires(std::array<double, kSupport> block) { row.add(local.first, block); }) {
      std::array<double, kSupport> block;
      for (std::size_t k = 0; k < kSupport; ++k) block[k] = a * u[k] + b * v[k];
      row.add(local.first, block);
    } else {
      for (int j = 0; j < 4; ++j) {
        const int first = (local.first[1] + j) * row_x.coefficients() + local.first[0];
        for (int i = 0; i < 4; ++i) row.add(first + i, a * u[4 * j + i] + b * v[4 * j + i]);
      }
    }
  }
};

/// RevolutionShape's.
struct RevolutionView {
  static constexpr int kSupport = 4;
  using Local = ShapeLocal<1>;

  double focal_mm = 1.0;
  KnotRow row;
  const double* coefficients = nullptr;
  HeightRange band;
  double curvature_bound = 0.0;
  const double* near_curvatures = nullptr;

  LUCERNA_HD const double* near_curvatures_at(double x, double y) const {
    return near_curvatures + std::ptrdiff_t{kNearSizes} * row.place(std::sqrt(x * x + y * y)).first;
  }
  LUCERNA_HD double cell_mm() const { return row.step_mm; }

  /// Offset from the base paraboloid at a radius, and its slope.
  LUCERNA_HD std::array<double, 2> offset_at(double r) const {
    const KnotRow::Place p = row.place(r);
    const CubicBasis b = cubic_basis(p.t), d = cubic_basis_slope(p.t);
    const double* c = coefficients + p.first;
    return {b[0] * c[0] + b[1] * c[1] + b[2] * c[2] + b[3] * c[3],
            (d[0] * c[0] + d[1] * c[1] + d[2] * c[2] + d[3] * c[3]) / row.step_mm};
  }
  LUCERNA_HD ShapeOffset offset(double x, double y) const {
    const double r = std::sqrt(x * x + y * y);
    const std::array<double, 2> at = offset_at(r);
    const double per_r = r > 0.0 ? at[1] / r : 0.0;
    return {at[0], x * per_r, y * per_r};
  }

  LUCERNA_HD Local local(double x, double y) const {
    const double r = std::sqrt(x * x + y * y);
    const KnotRow::Place p = row.place(r);
    Local l;
    l.first = {p.first};
    l.basis = {cubic_basis(p.t)};
    const CubicBasis d = cubic_basis_slope(p.t), e = cubic_basis_second(p.t);
    double slope = 0.0, bend = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      const double c = coefficients[static_cast<std::size_t>(p.first) + i];
      l.slope[0][i] = d[i] / row.step_mm;
      slope += l.slope[0][i] * c;
      bend += e[i] * c / (row.step_mm * row.step_mm);
    }
    const double k = 0.5 / focal_mm;
    const double per_r = r > 0.0 ? slope / r : bend;  // s'(r) / r tends to s''(0)
    l.along_x = r > 0.0 ? x / r : 0.0;
    l.along_y = r > 0.0 ? y / r : 0.0;
    const double across = bend - per_r;
    l.hx = (k + per_r) * x;
    l.hy = (k + per_r) * y;
    l.hxx = k + per_r + across * l.along_x * l.along_x;
    l.hxy = across * l.along_x * l.along_y;
    l.hyy = k + per_r + across * l.along_y * l.along_y;
    return l;
  }

  LUCERNA_HD void gradient(const Local& local, double alpha, double beta, double gamma, double* out) const {
    const double slope = beta * local.along_x + gamma * local.along_y;
    for (std::size_t k = 0; k < 4; ++k) out[k] = alpha * local.basis[0][k] + slope * local.slope[0][k];
  }
  template <class Row>
  LUCERNA_HD void add(const Local& local, double a, const double* u, double b, const double* v,
                      const Row& row_of) const {
    for (int k = 0; k < 4; ++k) row_of.add(local.first[0] + k, a * u[k] + b * v[k]);
  }
};

/// Height and gradient of a view.
template <class View>
LUCERNA_HD SurfacePoint smooth_point(const View& view, double x, double y) {
  const double k = 0.25 / view.focal_mm;
  const ShapeOffset o = view.offset(x, y);
  return {k * (x * x + y * y) + o.s, 2.0 * k * x + o.sx, 2.0 * k * y + o.sy};
}

}  // namespace lucerna
