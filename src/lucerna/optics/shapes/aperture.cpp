// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/reflector.h"

namespace lucerna {

namespace {

void check_size(const char* what, double size_mm) {
  if (!(size_mm > 0.0 && std::isfinite(size_mm))) {
    throw InputError(fmt::format("aperture: {} is {} mm, expected a finite number above 0", what, size_mm));
  }
}

void check_hole(double hole_diameter_mm, double limit_mm) {
  if (!(hole_diameter_mm >= 0.0 && hole_diameter_mm < limit_mm)) {
    throw InputError(fmt::format(
        "aperture: the hole of {} mm does not fit the aperture of {} mm, expected 0 <= hole < aperture",
        hole_diameter_mm, limit_mm));
  }
}

}  // namespace

Aperture::Aperture(ApertureShape shape, double half_x_mm, double half_y_mm, double hole_radius_mm)
    : shape_(shape), half_x_mm_(half_x_mm), half_y_mm_(half_y_mm), hole_radius_mm_(hole_radius_mm) {}

Aperture Aperture::circle(double diameter_mm, double hole_diameter_mm) {
  check_size("the diameter", diameter_mm);
  check_hole(hole_diameter_mm, diameter_mm);
  return {ApertureShape::circle, 0.5 * diameter_mm, 0.5 * diameter_mm, 0.5 * hole_diameter_mm};
}

Aperture Aperture::rectangle(double size_x_mm, double size_y_mm, double hole_diameter_mm) {
  check_size("the size along x", size_x_mm);
  check_size("the size along y", size_y_mm);
  check_hole(hole_diameter_mm, std::min(size_x_mm, size_y_mm));
  return {ApertureShape::rectangle, 0.5 * size_x_mm, 0.5 * size_y_mm, 0.5 * hole_diameter_mm};
}

double Aperture::outer_radius_mm() const {
  return shape_ == ApertureShape::circle ? half_x_mm_ : std::hypot(half_x_mm_, half_y_mm_);
}

bool Aperture::misses(const Rectangle& region) const {
  if (region.x0_mm > half_x_mm_ || region.x1_mm < -half_x_mm_) return true;
  if (region.y0_mm > half_y_mm_ || region.y1_mm < -half_y_mm_) return true;
  const RadiusRange r = radius_range(region);
  return r.max_mm < hole_radius_mm_ || (shape_ == ApertureShape::circle && r.min_mm > half_x_mm_);
}

RadiusRange radius_range(const Rectangle& region) {
  const double near_x = std::max({region.x0_mm, -region.x1_mm, 0.0});
  const double near_y = std::max({region.y0_mm, -region.y1_mm, 0.0});
  const double far_x = std::max(std::abs(region.x0_mm), std::abs(region.x1_mm));
  const double far_y = std::max(std::abs(region.y0_mm), std::abs(region.y1_mm));
  return {std::hypot(near_x, near_y), std::hypot(far_x, far_y)};
}

}  // namespace lucerna
