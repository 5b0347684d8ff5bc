// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector/reflector.h"

#include <utility>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

ConicProfile conic_profile(ConicPreset preset, double focal_mm, double focal2_mm, double r_max_mm) {
  switch (preset) {
    case ConicPreset::parabola:
      return ConicProfile::parabola(focal_mm, r_max_mm);
    case ConicPreset::ellipse:
      return ConicProfile::ellipse(focal_mm, focal2_mm, r_max_mm);
    case ConicPreset::hyperbola:
      break;
  }
  return ConicProfile::hyperbola(focal_mm, focal2_mm, r_max_mm);
}

}  // namespace

Reflector conic_reflector(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture) {
  auto profile =
      std::make_shared<ConicProfile>(conic_profile(preset, focal_mm, focal2_mm, aperture.outer_radius_mm()));
  return {std::make_shared<RevolutionSurface>(std::move(profile)), aperture};
}

Reflector profile_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture) {
  auto profile = std::make_shared<SplineProfile>(knots);
  if (aperture.outer_radius_mm() > profile->r_max_mm() * (1.0 + 1e-12)) {
    throw InputError(fmt::format("reflector: the profile ends at radius {} mm, the aperture reaches {} mm",
                                 profile->r_max_mm(), aperture.outer_radius_mm()));
  }
  if (profile->r_min_mm() > aperture.hole_radius_mm() * (1.0 + 1e-12)) {
    throw InputError(
        fmt::format("reflector: the profile starts at radius {} mm, the hole's radius is {} mm; "
                    "expected a profile from the axis or a hole at least as wide",
                    profile->r_min_mm(), aperture.hole_radius_mm()));
  }
  return {std::make_shared<RevolutionSurface>(std::move(profile)), aperture};
}

}  // namespace lucerna
