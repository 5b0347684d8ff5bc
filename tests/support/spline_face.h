// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "lucerna/optics/shapes/smooth_shape.h"

namespace lucerna::test {

/// Coefficients of a bicubic B-spline near `height(x, y)`, with `n` x `n` intervals over [-half_mm,
/// half_mm]^2: the quasi-interpolant (-1, 8, -1) / 6, which is exact for cubics.
template <class Height>
std::vector<double> spline_coefficients(Height&& height, double half_mm, int n) {
  constexpr std::array<double, 3> kWeight{-1.0 / 6.0, 8.0 / 6.0, -1.0 / 6.0};
  const double step = 2.0 * half_mm / n;
  std::vector<double> out;
  for (int j = 0; j < n + 3; ++j) {
    for (int i = 0; i < n + 3; ++i) {
      double sum = 0.0;
      for (int v = 0; v < 3; ++v) {
        for (int u = 0; u < 3; ++u) {
          sum += kWeight[static_cast<std::size_t>(u)] * kWeight[static_cast<std::size_t>(v)] *
                 height(-half_mm + step * (i + u - 2), -half_mm + step * (j + v - 2));
        }
      }
      out.push_back(sum);
    }
  }
  return out;
}

/// The spline of these coefficients, on no paraboloid.
template <class Height>
std::shared_ptr<const HeightSurface> spline_face(Height&& height, double half_mm, int n) {
  const KnotRow row{-half_mm, 2.0 * half_mm / n, n};
  return std::make_shared<SmoothSurface<BsplineShape>>(BsplineShape(
      std::numeric_limits<double>::infinity(), row, row, spline_coefficients(height, half_mm, n)));
}

}  // namespace lucerna::test
