// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/core/host_device.h"
#include "lucerna/reflector/height_surface.h"

namespace lucerna {

enum class ApertureShape { circle, rectangle };

/// The part of a height surface that is there: a circle or a rectangle about the z axis, less a round hole
/// for the lamp.
class Aperture {
 public:
  /// Throws InputError unless diameter > 0 and 0 <= hole < diameter.
  static Aperture circle(double diameter_mm, double hole_diameter_mm = 0.0);
  /// Throws InputError unless both sizes are > 0 and 0 <= hole < the smaller of them.
  static Aperture rectangle(double size_x_mm, double size_y_mm, double hole_diameter_mm = 0.0);

  /// True if (x, y) is on the mirror; outer rims belong to it, the hole's rim does too.
  bool contains(double x_mm, double y_mm) const {
    const double r2 = x_mm * x_mm + y_mm * y_mm;
    if (r2 < hole_radius_mm_ * hole_radius_mm_) return false;
    if (shape_ == ApertureShape::circle) return r2 <= half_x_mm_ * half_x_mm_;
    return x_mm <= half_x_mm_ && x_mm >= -half_x_mm_ && y_mm <= half_y_mm_ && y_mm >= -half_y_mm_;
  }

  /// The smallest rectangle about it.
  Rectangle bounds() const { return {-half_x_mm_, half_x_mm_, -half_y_mm_, half_y_mm_}; }
  /// Distance of its farthest point from the axis.
  double outer_radius_mm() const;
  LUCERNA_HD double hole_radius_mm() const { return hole_radius_mm_; }
  LUCERNA_HD double half_x_mm() const { return half_x_mm_; }
  LUCERNA_HD double half_y_mm() const { return half_y_mm_; }
  LUCERNA_HD ApertureShape shape() const { return shape_; }

  /// True if no point of `region` is on the mirror.
  bool misses(const Rectangle& region) const;

 private:
  Aperture(ApertureShape shape, double half_x_mm, double half_y_mm, double hole_radius_mm);
  ApertureShape shape_;
  double half_x_mm_, half_y_mm_, hole_radius_mm_;
};

/// Least and greatest distance from the origin to points of `region`.
struct RadiusRange {
  double least_mm = 0.0, greatest_mm = 0.0;
};
RadiusRange radius_range(const Rectangle& region);

}  // namespace lucerna
