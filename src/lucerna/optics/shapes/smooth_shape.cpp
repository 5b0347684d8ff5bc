// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/smooth_shape.h"

#include <algorithm>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

HeightRange hull(const std::vector<double>& c) {
  const auto [low, high] = std::minmax_element(c.begin(), c.end());
  return {*low, *high};
}

/// The maximum of each cell's neighbourhoods, cells x kNearSizes.
std::vector<double> max_near(const std::vector<double>& curvatures, int nx, int ny) {
  std::vector<double> out;
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      for (int k = 0; k < kNearSizes; ++k) {
        const int size = near_cells(k);
        double max = 0.0;
        for (int v = std::max(0, j - size); v <= std::min(ny - 1, j + size); ++v) {
          for (int u = std::max(0, i - size); u <= std::min(nx - 1, i + size); ++u) {
            max = std::max(max, curvatures[static_cast<std::size_t>(v * nx + u)]);
          }
        }
        out.push_back(max);
      }
    }
  }
  return out;
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
  const auto c = [&](int i, int j) { return c_[static_cast<std::size_t>(j * nx + i)]; };
  const auto curvature_of = [&](int i0, int j0) {
    double xx = 0.0, yy = 0.0, xy = 0.0;
    for (int j = j0; j < j0 + 4; ++j) {
      for (int i = i0; i < i0 + 4; ++i) {
        if (i > i0 + 1) xx = std::max(xx, std::abs(c(i - 2, j) - 2.0 * c(i - 1, j) + c(i, j)));
        if (j > j0 + 1) yy = std::max(yy, std::abs(c(i, j - 2) - 2.0 * c(i, j - 1) + c(i, j)));
        if (i > i0 && j > j0) {
          xy = std::max(xy, std::abs(c(i, j) - c(i - 1, j) - c(i, j - 1) + c(i - 1, j - 1)));
        }
      }
    }
    return std::max(xx / (x_.step_mm * x_.step_mm), yy / (y_.step_mm * y_.step_mm)) +
           xy / (x_.step_mm * y_.step_mm);
  };
  std::vector<double> curvatures;
  for (int j = 0; j < y_.intervals; ++j) {
    for (int i = 0; i < x_.intervals; ++i) curvatures.push_back(curvature_of(i, j));
  }
  curvature_bound_ = *std::max_element(curvatures.begin(), curvatures.end());
  near_curvatures_ = max_near(curvatures, x_.intervals, y_.intervals);
}

RevolutionShape::RevolutionShape(double focal_mm, KnotRow row, std::vector<double> coefficients)
    : focal_mm_(focal_mm), row_(row), c_(std::move(coefficients)) {
  LUCERNA_CHECK(c_.size() == static_cast<std::size_t>(row_.coefficients()), "{} coefficients, expected {}",
                c_.size(), row_.coefficients());
  LUCERNA_CHECK(row_.start_mm == 0.0 && c_[0] == c_[2], "a profile that is not mirrored at the axis");
  band_ = hull(c_);
  // Both principal bends of the swept surface, s'' and s' / r, are at most the largest |s''| from the axis to
  // there.
  double inner = 0.0;
  std::vector<double> curvatures;
  for (std::size_t i = 0; i + 3 < c_.size(); ++i) {
    for (std::size_t k = i + 1; k < i + 3; ++k) {
      inner = std::max(inner, std::abs(c_[k - 1] - 2.0 * c_[k] + c_[k + 1]) / (row_.step_mm * row_.step_mm));
    }
    curvatures.push_back(inner);
  }
  curvature_bound_ = inner;
  near_curvatures_ = max_near(curvatures, row_.intervals, 1);
}

}  // namespace lucerna
