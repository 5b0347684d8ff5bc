// SPDX-License-Identifier: Apache-2.0
#include "lucerna/geometry.h"

namespace lucerna {

Frame Frame::rotation(const Direction& axis, double angle_rad) {
  // Rodrigues' formula, column by column. Quarter turns are exact, so that "rotate by 90" leaves no dust.
  const double quarters = angle_rad / (0.5 * std::numbers::pi);
  double c = std::cos(angle_rad), s = std::sin(angle_rad);
  if (std::abs(quarters - std::round(quarters)) < 1e-14 * (1.0 + std::abs(quarters))) {
    c = std::round(c);
    s = std::round(s);
  }
  const auto turned = [&](const Vec3& v) {
    return c * v + s * cross(axis, v) + ((1.0 - c) * dot(axis, v)) * axis.vec();
  };
  return {turned({1, 0, 0}), turned({0, 1, 0}), turned({0, 0, 1}), {}};
}

Frame Frame::from_axis(const Direction& axis, double turn_rad, const Vec3& position_mm) {
  const Vec3 z{0.0, 0.0, 1.0};
  const Vec3 hinge = cross(z, axis);
  const double hinge_length = length(hinge);
  Frame tilt;
  if (hinge_length > 0.0) {
    tilt = rotation(Direction::from(hinge), std::atan2(hinge_length, axis.z()));
  } else if (axis.z() < 0.0) {
    tilt = rotation(Direction::from_unit({1, 0, 0}), std::numbers::pi);
  }
  const Frame turned = rotation(axis, turn_rad) * tilt;
  return {turned.ex_, turned.ey_, turned.ez_, position_mm};
}

}  // namespace lucerna
