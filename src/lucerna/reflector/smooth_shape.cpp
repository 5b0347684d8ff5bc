// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector/smooth_shape.h"

#include <algorithm>
#include <utility>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

HeightRange hull(const std::vector<double>& c) {
  const auto [low, high] = std::minmax_element(c.begin(), c.end());
  return {*low, *high};
}

}  // namespace

BsplineShape::BsplineShape(double focal_mm, KnotRow row_x, KnotRow row_y, std::vector<double> coefficients)
    : focal_mm_(focal_mm), x_(row_x), y_(row_y), c_(std::move(coefficients)) {
  const int nx = x_.coefficients(), ny = y_.coefficients();
  LUCERNA_CHECK(c_.size() == static_cast<std::size_t>(nx * ny), "{} coefficients, expected {} x {}",
                c_.size(), nx, ny);
  band_ = hull(c_);
  // Second derivatives of a B-spline are splines of lower degree on the differences of its coefficients, so
  // the largest differences bound them; a symmetric 2 x 2 matrix bends at most max(|xx|, |yy|) + |xy|.
  double xx = 0.0, yy = 0.0, xy = 0.0;
  const auto c = [&](int i, int j) { return c_[static_cast<std::size_t>(j * nx + i)]; };
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      if (i > 0 && i + 1 < nx) xx = std::max(xx, std::abs(c(i - 1, j) - 2.0 * c(i, j) + c(i + 1, j)));
      if (j > 0 && j + 1 < ny) yy = std::max(yy, std::abs(c(i, j - 1) - 2.0 * c(i, j) + c(i, j + 1)));
      if (i > 0 && j > 0) {
        xy = std::max(xy, std::abs(c(i, j) - c(i - 1, j) - c(i, j - 1) + c(i - 1, j - 1)));
      }
    }
  }
  bend_bound_ = std::max(xx / (x_.step_mm * x_.step_mm), yy / (y_.step_mm * y_.step_mm)) +
                xy / (x_.step_mm * y_.step_mm);
}

ShapeOffset BsplineShape::offset(double x, double y) const {
  const KnotRow::Place px = x_.place(x), py = y_.place(y);
  const CubicBasis bx = cubic_basis(px.t), dx = cubic_basis_slope(px.t);
  const CubicBasis by = cubic_basis(py.t), dy = cubic_basis_slope(py.t);
  const int nx = x_.coefficients();
  const double* c = c_.data() + py.first * nx + px.first;
  ShapeOffset o;
  for (std::size_t j = 0; j < 4; ++j, c += nx) {
    const double value = bx[0] * c[0] + bx[1] * c[1] + bx[2] * c[2] + bx[3] * c[3];
    const double slope = dx[0] * c[0] + dx[1] * c[1] + dx[2] * c[2] + dx[3] * c[3];
    o.s += by[j] * value;
    o.sx += by[j] * slope;
    o.sy += dy[j] * value;
  }
  o.sx /= x_.step_mm;
  o.sy /= y_.step_mm;
  return o;
}

BsplineShape::Local BsplineShape::local(double x, double y) const {
  const KnotRow::Place px = x_.place(x), py = y_.place(y);
  const CubicBasis bx = cubic_basis(px.t), dx = cubic_basis_slope(px.t), ex = cubic_basis_bend(px.t);
  const CubicBasis by = cubic_basis(py.t), dy = cubic_basis_slope(py.t), ey = cubic_basis_bend(py.t);
  const int nx = x_.coefficients();
  const double* c = c_.data() + py.first * nx + px.first;
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
  const double px1 = 1.0 / x_.step_mm, py1 = 1.0 / y_.step_mm, k = 0.5 / focal_mm_;
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

RevolutionShape::RevolutionShape(double focal_mm, KnotRow row, std::vector<double> coefficients)
    : focal_mm_(focal_mm), row_(row), c_(std::move(coefficients)) {
  LUCERNA_CHECK(c_.size() == static_cast<std::size_t>(row_.coefficients()), "{} coefficients, expected {}",
                c_.size(), row_.coefficients());
  LUCERNA_CHECK(row_.start_mm == 0.0 && c_[0] == c_[2], "a profile that is not mirrored at the axis");
  band_ = hull(c_);
  // Both principal bends of the swept surface, s'' and s' / r, are at most the largest |s''|.
  for (std::size_t i = 1; i + 1 < c_.size(); ++i) {
    bend_bound_ = std::max(bend_bound_, std::abs(c_[i - 1] - 2.0 * c_[i] + c_[i + 1]));
  }
  bend_bound_ /= row_.step_mm * row_.step_mm;
}

RevolutionShape::Local RevolutionShape::local(double x, double y) const {
  const double r = std::sqrt(x * x + y * y);
  const KnotRow::Place p = row_.place(r);
  Local l;
  l.first = {p.first};
  l.basis = {cubic_basis(p.t)};
  const CubicBasis d = cubic_basis_slope(p.t), e = cubic_basis_bend(p.t);
  double slope = 0.0, bend = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    const double c = c_[static_cast<std::size_t>(p.first) + i];
    l.slope[0][i] = d[i] / row_.step_mm;
    slope += l.slope[0][i] * c;
    bend += e[i] * c / (row_.step_mm * row_.step_mm);
  }
  const double k = 0.5 / focal_mm_;
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

}  // namespace lucerna
