// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/cad/step_curves.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"

namespace lucerna {

std::vector<double> clamped_coefficients(const std::vector<double>& c) {
  const std::size_t n = c.size();
  std::vector<double> d = c;
  d[0] = (c[0] + 4.0 * c[1] + c[2]) / 6.0;
  d[1] = (2.0 * c[1] + c[2]) / 3.0;
  d[n - 2] = (c[n - 3] + 2.0 * c[n - 2]) / 3.0;
  d[n - 1] = (c[n - 3] + 4.0 * c[n - 2] + c[n - 1]) / 6.0;
  return d;
}

ClampedRow::ClampedRow(const KnotRow& row) {
  for (int i = 0; i <= row.intervals; ++i) {
    knots.push_back(i == row.intervals ? row.end_mm() : row.start_mm + row.step_mm * i);
    multiplicity.push_back(i == 0 || i == row.intervals ? 4 : 1);
  }
  const auto knot = [&](int i) { return knots[static_cast<std::size_t>(std::clamp(i, 0, row.intervals))]; };
  for (int i = 0; i < row.coefficients(); ++i) {
    const double a = knot(i - 2), b = knot(i - 1), c = knot(i);
    x.push_back((a + b + c) / 3.0);
    square.push_back((a * b + b * c + c * a) / 3.0);
  }
}

StepCurve step_cubic(double a, double b, const std::function<std::array<Vec3, 2>(double)>& curve) {
  constexpr double kClose_mm = 1e-6;
  constexpr int kMaxPieces = 1 << 14;
  for (int n = 8;; n *= 2) {
    StepCurve out;
    const double h = (b - a) / n;
    double worst = 0.0;
    auto [p, d] = curve(a);
    out.poles = {p};
    for (int i = 0; i < n; ++i) {
      const auto [q, e] = curve(i + 1 == n ? b : a + h * (i + 1));
      const Vec3 b1 = p + (h / 3.0) * d, b2 = q - (h / 3.0) * e;
      const Vec3 middle = 0.125 * p + 0.375 * b1 + 0.375 * b2 + 0.125 * q;
      worst = std::max(worst, length(middle - curve(a + h * (i + 0.5))[0]));
      out.poles.push_back(b1);
      out.poles.push_back(b2);
      p = q;
      d = e;
    }
    out.poles.push_back(p);
    for (int i = 0; i <= n; ++i) {
      out.knots.push_back(i == n ? b : a + h * i);
      out.multiplicity.push_back(i == 0 || i == n ? 4 : 2);
    }
    if (worst <= kClose_mm) return out;
    if (n >= kMaxPieces) {
      throw InputError("CAD: STEP: the surface bends too sharply at its rim to follow it within 1e-6 mm");
    }
  }
}

StepCurve step_quarter(const HeightSurface& surface, double r_mm, int quadrant) {
  return step_cubic(0.5 * std::numbers::pi * quadrant, 0.5 * std::numbers::pi * (quadrant + 1),
                    [&](double angle) {
                      const double c = r_mm * std::cos(angle), s = r_mm * std::sin(angle);
                      const SurfacePoint p = surface.at(c, s);
                      return std::array<Vec3, 2>{Vec3{c, s, p.z_mm}, Vec3{-s, c, -s * p.dzdx + c * p.dzdy}};
                    });
}

StepSurface step_surface(const BsplineShape& shape) {
  const ClampedRow x(shape.row_x()), y(shape.row_y());
  const std::size_t nx = x.x.size(), ny = y.x.size();
  std::vector<std::vector<double>> rows(ny);  // along x first, then along y
  for (std::size_t j = 0; j < ny; ++j) {
    const auto from = shape.coefficients().begin() + static_cast<std::ptrdiff_t>(j * nx);
    rows[j] = clamped_coefficients({from, from + static_cast<std::ptrdiff_t>(nx)});
  }
  StepSurface s{nx, {}, x.knots, y.knots, x.multiplicity, y.multiplicity};
  s.poles.resize(nx * ny);
  const double k = 0.25 / shape.focal_mm();
  for (std::size_t i = 0; i < nx; ++i) {
    std::vector<double> column(ny);
    for (std::size_t j = 0; j < ny; ++j) column[j] = rows[j][i];
    column = clamped_coefficients(column);
    for (std::size_t j = 0; j < ny; ++j) {
      s.poles[j * nx + i] = {x.x[i], y.x[j], k * (x.square[i] + y.square[j]) + column[j]};
    }
  }
  return s;
}

}  // namespace lucerna
