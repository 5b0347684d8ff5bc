// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "lucerna/optics/shapes/spline_surface.h"
#include "lucerna/random.h"
#include "lucerna/reflector.h"

namespace lucerna {

/// A paraboloid with pillows, as a revolution surface has none.
class Pillows final : public HeightSurface {
 public:
  explicit Pillows(double focal_mm) : f_(4.0 * focal_mm) {}
  SurfacePoint at(double x, double y) const override {
    return {(x * x + y * y) / f_ + 0.4 * std::cos(k_ * x) * std::cos(k_ * y),
            2.0 * x / f_ - 0.4 * k_ * std::sin(k_ * x) * std::cos(k_ * y),
            2.0 * y / f_ - 0.4 * k_ * std::cos(k_ * x) * std::sin(k_ * y)};
  }
  HeightRange range(const Rectangle& r) const override {
    const RadiusRange q = radius_range(r);
    return {q.min_mm * q.min_mm / f_ - 0.4, q.max_mm * q.max_mm / f_ + 0.4};
  }

 private:
  double f_, k_ = 2.0 * std::numbers::pi / 8.0;
};

/// A free-form mirror on a paraboloid.
inline std::shared_ptr<const HeightSurface> free_form() {
  Rng rng(4, 0);
  std::vector<double> c(std::size_t{14} * 12);
  for (double& x : c) x = 2.0 * rng.uniform();
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::rectangle(90.0, 70.0));
  return std::make_shared<SplineSurface>(Rectangle{-45.0, 45.0, -35.0, 35.0}, 14, 12, c, base.surface);
}

/// A mirror of every kind that is traced as a height field, 90 mm wide.
inline std::vector<Reflector> height_fields() {
  const Aperture round = Aperture::circle(90.0, 12.0), box = Aperture::rectangle(90.0, 70.0);
  return {conic_reflector(ConicPreset::parabola, 15.0, 0.0, round),
          conic_reflector(ConicPreset::ellipse, 25.0, 120.0, round),
          conic_reflector(ConicPreset::hyperbola, 25.0, 120.0, box),
          profile_reflector({{0.0, 0.0}, {10.0, 3.0}, {20.0, 4.0}, {30.0, 12.0}, {45.0, 40.0}}, round),
          profile_reflector({{0.0, 10.0}, {20.0, 6.0}, {30.0, 3.0}, {45.0, -5.0}}, round),
          {std::make_shared<Pillows>(15.0), box},
          {std::make_shared<Pillows>(5.0), round},
          {free_form(), box},
          conic_trough(ConicPreset::parabola, 10.0, 0.0, box),
          profile_trough({{0.0, 0.0}, {20.0, 9.0}, {30.0, 10.0}, {45.0, 40.0}}, box)};
}

}  // namespace lucerna
