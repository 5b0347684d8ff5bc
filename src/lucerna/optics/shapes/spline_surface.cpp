// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/spline_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Where a coordinate lies: patch, and place in it (may leave [0, 1] a little beyond the sides).
struct Place {
  std::size_t patch;
  double u;
};

Place place(double x, double x0, double step, std::size_t patches) {
  const double g = (x - x0) / step;
  const double last = static_cast<double>(patches) - 1.0;
  const double patch = std::clamp(std::floor(g), 0.0, last);
  return {static_cast<std::size_t>(patch), g - patch};
}

struct Weights {
  std::array<double, 4> value, slope;
};

Weights weights(double u) {
  const double w = 1.0 - u;
  return {{w * w * w / 6.0, (4.0 + u * u * (3.0 * u - 6.0)) / 6.0, (4.0 + w * w * (3.0 * w - 6.0)) / 6.0,
           u * u * u / 6.0},
          {-0.5 * w * w, 0.5 * u * (3.0 * u - 4.0), -0.5 * w * (3.0 * w - 4.0), 0.5 * u * u}};
}

/// Coefficients of the cubic spline through values at 0, 1, ... n - 1 with knots there, n + 2 of them; the
/// third difference of the coefficients vanishes at both ends (not-a-knot). c_{i-1} + 4 c_i + c_{i+1} = 6
/// f_i.
std::vector<double> interpolate(const std::vector<double>& f) {
  const std::size_t n = f.size();
  // With the end conditions the first two equations give c_1 and c_2's relation; in terms of second
  // differences d_i = c_{i-1} - 2 c_i + c_{i+1}: f_i = c_i + d_i / 6, and d_0 = 2 d_1 - d_2, d_{n-1} = 2
  // d_{n-2} - d_{n-3}. Second differences of f: d_i + (d_{i-1} - 2 d_i + d_{i+1}) / 6 = f_{i-1} - 2 f_i +
  // f_{i+1} for 1 <= i <= n - 2.
  std::vector<double> lower(n, 1.0 / 6.0), diagonal(n, 4.0 / 6.0), upper(n, 1.0 / 6.0), d(n, 0.0);
  for (std::size_t i = 1; i + 1 < n; ++i) d[i] = f[i - 1] - 2.0 * f[i] + f[i + 1];
  diagonal[1] += 2.0 / 6.0;
  upper[1] -= 1.0 / 6.0;
  diagonal[n - 2] += 2.0 / 6.0;
  lower[n - 2] -= 1.0 / 6.0;
  for (std::size_t i = 2; i + 1 < n; ++i) {
    const double w = lower[i] / diagonal[i - 1];
    diagonal[i] -= w * upper[i - 1];
    d[i] -= w * d[i - 1];
  }
  d[n - 2] /= diagonal[n - 2];
  for (std::size_t i = n - 2; i-- > 1;) d[i] = (d[i] - upper[i] * d[i + 1]) / diagonal[i];
  d[0] = 2.0 * d[1] - d[2];
  d[n - 1] = 2.0 * d[n - 2] - d[n - 3];
  std::vector<double> c(n + 2);
  for (std::size_t i = 0; i < n; ++i) c[i + 1] = f[i] - d[i] / 6.0;
  c[0] = d[0] + 2.0 * c[1] - c[2];
  c[n + 1] = d[n - 1] + 2.0 * c[n] - c[n - 1];
  return c;
}

}  // namespace

SplineSurface::SplineSurface(const Rectangle& region, std::size_t nx, std::size_t ny,
                             std::vector<double> coefficients, std::shared_ptr<const HeightSurface> base)
    : region_(region), nx_(nx), ny_(ny), coefficients_(std::move(coefficients)), base_(std::move(base)) {
  if (nx < 4 || ny < 4)
    throw InputError(fmt::format("spline surface: {} x {} coefficients, expected at least 4 x 4", nx, ny));
  if (coefficients_.size() / ny != nx || coefficients_.size() % ny != 0) {
    throw InputError(
        fmt::format("spline surface: {} coefficients for {} x {}", coefficients_.size(), nx, ny));
  }
  if (!(region.x1_mm > region.x0_mm && region.y1_mm > region.y0_mm))
    throw InputError("spline surface: the region is empty");
  for (std::size_t i = 0; i < coefficients_.size(); ++i) {
    if (!std::isfinite(coefficients_[i])) {
      throw InputError(fmt::format("spline surface: row {}, column {} is {}, expected a finite number",
                                   i / nx + 1, i % nx + 1, coefficients_[i]));
    }
  }
  step_x_ = (region.x1_mm - region.x0_mm) / static_cast<double>(nx - 3);
  step_y_ = (region.y1_mm - region.y0_mm) / static_cast<double>(ny - 3);
}

SplineSurface SplineSurface::through(const Rectangle& region, std::size_t nx, std::size_t ny,
                                     const std::vector<double>& heights_mm) {
  if (nx < 4 || ny < 4)
    throw InputError(fmt::format("height map: {} x {} heights, expected at least 4 x 4", nx, ny));
  if (heights_mm.size() / ny != nx || heights_mm.size() % ny != 0) {
    throw InputError(fmt::format("height map: {} heights for {} x {}", heights_mm.size(), nx, ny));
  }
  for (std::size_t i = 0; i < heights_mm.size(); ++i) {
    if (!std::isfinite(heights_mm[i])) {
      throw InputError(fmt::format("height map: row {}, column {} is {}, expected a finite number",
                                   i / nx + 1, i % nx + 1, heights_mm[i]));
    }
  }
  std::vector<double> rows((nx + 2) * ny), all((nx + 2) * (ny + 2)), line(nx), column(ny);
  for (std::size_t j = 0; j < ny; ++j) {
    std::copy_n(heights_mm.begin() + static_cast<std::ptrdiff_t>(j * nx), nx, line.begin());
    const std::vector<double> c = interpolate(line);
    std::copy(c.begin(), c.end(), rows.begin() + static_cast<std::ptrdiff_t>(j * (nx + 2)));
  }
  for (std::size_t i = 0; i < nx + 2; ++i) {
    for (std::size_t j = 0; j < ny; ++j) column[j] = rows[j * (nx + 2) + i];
    const std::vector<double> c = interpolate(column);
    for (std::size_t j = 0; j < ny + 2; ++j) all[j * (nx + 2) + i] = c[j];
  }
  return {region, nx + 2, ny + 2, std::move(all)};
}

SurfacePoint SplineSurface::at(double x_mm, double y_mm) const {
  const double over_x = 0.1 * (region_.x1_mm - region_.x0_mm), over_y = 0.1 * (region_.y1_mm - region_.y0_mm);
  const double x = std::clamp(x_mm, region_.x0_mm - over_x, region_.x1_mm + over_x);
  const double y = std::clamp(y_mm, region_.y0_mm - over_y, region_.y1_mm + over_y);
  const Place px = place(x, region_.x0_mm, step_x_, nx_ - 3), py = place(y, region_.y0_mm, step_y_, ny_ - 3);
  const Weights wx = weights(px.u), wy = weights(py.u);
  SurfacePoint s;
  for (std::size_t j = 0; j < 4; ++j) {
    const double* const c = &coefficients_[(py.patch + j) * nx_ + px.patch];
    double value = 0.0, slope = 0.0;
    for (std::size_t i = 0; i < 4; ++i) {
      value += wx.value[i] * c[i];
      slope += wx.slope[i] * c[i];
    }
    s.z_mm += wy.value[j] * value;
    s.dzdx += wy.value[j] * slope / step_x_;
    s.dzdy += wy.slope[j] * value / step_y_;
  }
  s.z_mm += s.dzdx * (x_mm - x) + s.dzdy * (y_mm - y);
  if (base_) {
    const SurfacePoint b = base_->at(x_mm, y_mm);
    s = {s.z_mm + b.z_mm, s.dzdx + b.dzdx, s.dzdy + b.dzdy};
  }
  return s;
}

HeightRange SplineSurface::range(const Rectangle& r) const {
  const Place x0 = place(r.x0_mm, region_.x0_mm, step_x_, nx_ - 3),
              x1 = place(r.x1_mm, region_.x0_mm, step_x_, nx_ - 3);
  const Place y0 = place(r.y0_mm, region_.y0_mm, step_y_, ny_ - 3),
              y1 = place(r.y1_mm, region_.y0_mm, step_y_, ny_ - 3);
  // Heights over the plane that touches the spline in the middle of the region: much tighter than heights as
  // they are where the surface is steep. A plane's own coefficients are its values at the Greville points.
  const double mx = 0.5 * (r.x0_mm + r.x1_mm), my = 0.5 * (r.y0_mm + r.y1_mm);
  SurfacePoint m = at(mx, my);
  HeightRange base{0.0, 0.0};
  if (base_) {
    const SurfacePoint b = base_->at(mx, my);
    m = {m.z_mm - b.z_mm, m.dzdx - b.dzdx, m.dzdy - b.dzdy};
    base = base_->range(r);
  }
  double low = 1e300, high = -1e300;
  for (std::size_t j = y0.patch; j <= y1.patch + 3; ++j) {
    const double y = region_.y0_mm + (static_cast<double>(j) - 1.0) * step_y_ - my;
    for (std::size_t i = x0.patch; i <= x1.patch + 3; ++i) {
      const double x = region_.x0_mm + (static_cast<double>(i) - 1.0) * step_x_ - mx;
      const double c = coefficients_[j * nx_ + i] - m.z_mm - m.dzdx * x - m.dzdy * y;
      low = std::min(low, c);
      high = std::max(high, c);
    }
  }
  const double tilt = 0.5 * (std::abs(m.dzdx) * (r.x1_mm - r.x0_mm) + std::abs(m.dzdy) * (r.y1_mm - r.y0_mm));
  return {base.low_mm + m.z_mm + low - tilt, base.high_mm + m.z_mm + high + tilt};
}

bool SplineSurface::convex_over(const Rectangle& r) const {
  // Beyond its rectangle the spline goes on by another rule.
  if (r.x0_mm < region_.x0_mm || r.x1_mm > region_.x1_mm || r.y0_mm < region_.y0_mm ||
      r.y1_mm > region_.y1_mm)
    return false;
  if (base_ && !base_->convex_over(r)) return false;
  const std::size_t x0 = place(r.x0_mm, region_.x0_mm, step_x_, nx_ - 3).patch,
                    x1 = place(r.x1_mm, region_.x0_mm, step_x_, nx_ - 3).patch;
  const std::size_t y0 = place(r.y0_mm, region_.y0_mm, step_y_, ny_ - 3).patch,
                    y1 = place(r.y1_mm, region_.y0_mm, step_y_, ny_ - 3).patch;
  for (std::size_t py = y0; py <= y1; ++py) {
    for (std::size_t px = x0; px <= x1; ++px) {
      if (!convex_patch(px, py)) return false;
    }
  }
  return true;
}

/// A derivative of a B-spline is one of lower degree, whose coefficients are differences of the coefficients.
bool SplineSurface::convex_patch(std::size_t px, std::size_t py) const {
  const auto c = [&](std::size_t i, std::size_t j) { return coefficients_[(py + j) * nx_ + px + i]; };
  double min_xx = 1e300, min_yy = 1e300, max_xy = 0.0;
  for (std::size_t j = 0; j < 4; ++j) {
    for (std::size_t i = 0; i < 2; ++i) {
      min_xx = std::min(min_xx, c(i, j) - 2.0 * c(i + 1, j) + c(i + 2, j));
      min_yy = std::min(min_yy, c(j, i) - 2.0 * c(j, i + 1) + c(j, i + 2));
    }
  }
  for (std::size_t j = 0; j < 3; ++j) {
    for (std::size_t i = 0; i < 3; ++i)
      max_xy = std::max(max_xy, std::abs(c(i + 1, j + 1) - c(i + 1, j) - c(i, j + 1) + c(i, j)));
  }
  // The steps cancel in the determinant.
  return min_xx >= 0.0 && min_yy >= 0.0 && min_xx * min_yy >= max_xy * max_xy;
}

}  // namespace lucerna
