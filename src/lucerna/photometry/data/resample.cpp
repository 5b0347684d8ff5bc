// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/data/resample.h"

#include <algorithm>
#include <cmath>

#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

void keep_flux(IntensityDistribution& d, double flux) {
  const double now = total_flux(d);
  if (now > 0.0) scale(d, flux / now);
}

/// The smallest step of ascending angles, at most `limit`, as a whole fraction of `range`.
double step_for(const std::vector<double>& angles, double limit, double range) {
  double step = limit;
  for (std::size_t i = 1; i < angles.size(); ++i) step = std::min(step, angles[i] - angles[i - 1]);
  step = std::max(step, 0.25);
  return range / std::ceil(range / step - 1e-9);
}

}  // namespace

Direction rotated_by(const Direction& direction, const Vec3& rotation_rad) {
  const double angle = length(rotation_rad);
  if (angle == 0.0) return direction;
  const Vec3 axis = rotation_rad / angle, v = direction.vec();
  const double c = std::cos(angle), s = std::sin(angle);
  return Direction::from(c * v + s * cross(axis, v) + (1.0 - c) * dot(axis, v) * axis);
}

IntensityDistribution resampled(const IntensityDistribution& from, std::vector<double> c_deg,
                                std::vector<double> gamma_deg) {
  IntensityDistribution d = zero_distribution(std::move(c_deg), std::move(gamma_deg), from.unit);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      d.at(c, g) = intensity_at(from, d.c_deg[c], d.gamma_deg[g]);
    }
  }
  keep_flux(d, total_flux(from));
  return d;
}

IntensityDistribution rotated(const IntensityDistribution& from, const Vec3& rotation_rad) {
  IntensityDistribution d =
      uniform_distribution(step_for(from.c_deg, 5.0, 360.0), step_for(from.gamma_deg, 1.0, 180.0), from.unit);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      // At the poles every plane must look the same way.
      const bool pole = g == 0 || g + 1 == d.gamma_deg.size();
      const Direction to = direction_from_type_c({pole ? 0.0 : radians(d.c_deg[c]), radians(d.gamma_deg[g])});
      d.at(c, g) = intensity_in(from, rotated_by(to, -rotation_rad));
    }
  }
  keep_flux(d, total_flux(from));
  return d;
}

}  // namespace lucerna
