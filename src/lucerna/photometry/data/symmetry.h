// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/intensity.h"

namespace lucerna {

/// The symmetries that photometric files can name, in the luminaire frame. Values are EULUMDAT's Isym.
enum class Symmetry {
  none = 0,
  rotational = 1,
  plane_c0_c180 = 2,   ///< I(C) = I(360 - C): planes 0..180 say all
  plane_c90_c270 = 3,  ///< I(C) = I(180 - C): planes 90..270 say all
  both_planes = 4,     ///< planes 0..90 say all
};

/// The highest symmetry that the values have, each pair within `tolerance` (cd, >= 0), and whose mirror
/// planes lie on grid planes that mirror onto each other within 1e-6 deg. Rotational needs equal planes only.
/// O(values).
Symmetry find_symmetry(const IntensityDistribution& distribution, double tolerance);

/// The same intensities in a frame turned so that the plane at `c_origin_deg` becomes C0 (new C = C -
/// c_origin). If no grid plane lies there one is interpolated, which leaves `total_flux` and every intensity
/// as they were. O(values).
IntensityDistribution turned(const IntensityDistribution& distribution, double c_origin_deg);

/// The symmetric part of a distribution: every value replaced by the mean over its mirror images (or planes),
/// which keeps `total_flux`. Throws InputError if the grid's planes do not mirror onto each other. For `none`
/// a copy. O(values).
IntensityDistribution symmetrised(const IntensityDistribution& distribution, Symmetry symmetry);

/// Index of the plane at `c_deg` (any real; within 1e-6 deg), or -1.
std::ptrdiff_t plane_index(const IntensityDistribution& distribution, double c_deg);

}  // namespace lucerna
