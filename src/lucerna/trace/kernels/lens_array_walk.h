// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/lens_array.h"

namespace lucerna {

/// Where a ray meets an array of lenslets.
struct LensArrayHit {
  double t_mm = 0.0;
  /// Of the lenslet, towards +z.
  Direction normal;
};

/// The first point in (0, infinity) of a ray on an array, within `aperture`. It goes from cell to cell;
/// within one, the lenslet is met exactly, by a quadratic about the cell's centre. Thread safe. O(cells
/// passed).
std::optional<LensArrayHit> first_lens_array_hit(const LensArraySurface& surface, const Aperture& aperture,
                                                 const Ray& ray);

}  // namespace lucerna
