// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/reflector/aperture.h"
#include "lucerna/reflector/height_surface.h"
#include "lucerna/reflector/profile.h"

namespace lucerna {

/// A mirror in its own frame: a shape and the part of it that is there.
struct Reflector {
  std::shared_ptr<const HeightSurface> surface;
  Aperture aperture = Aperture::circle(1.0);
};

enum class ConicPreset { parabola, ellipse, hyperbola };

/// A conic of revolution. `focal2_mm` counts for ellipse and hyperbola only. Errors as in ConicProfile.
Reflector conic_reflector(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture);

/// A surface of revolution from a spline profile (SplineProfile). Throws InputError as that does, and where
/// the aperture is wider than the profile or the profile starts outside the hole.
Reflector profile_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture);

/// Troughs along y from the same profiles, over |x|. Errors alike; the aperture's half width counts as its
/// radius.
Reflector conic_trough(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture);
Reflector profile_trough(const std::vector<ProfileKnot>& knots, const Aperture& aperture);

}  // namespace lucerna
