// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/intensity.h"

namespace lucerna {

/// The rotation by |v| radians about v (right-handed), applied to `direction`: Rodrigues' formula.
Direction rotated_by(const Direction& direction, const Vec3& rotation_rad);

/// The distribution on another grid, bilinear, scaled to the same `total_flux`. Angles as for
/// IntensityDistribution.
IntensityDistribution resampled(const IntensityDistribution& distribution, std::vector<double> c_deg,
                                std::vector<double> gamma_deg);

/// The light after the luminaire was turned by the rotation vector (rad, right-handed, luminaire frame), on a
/// full-sphere grid with the steps of the old one (at most 1 degree in gamma, 5 in C), scaled to the same
/// flux.
IntensityDistribution rotated(const IntensityDistribution& distribution, const Vec3& rotation_rad);

}  // namespace lucerna
