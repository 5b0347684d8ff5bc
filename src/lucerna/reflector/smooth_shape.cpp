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

}  // namespace lucerna
