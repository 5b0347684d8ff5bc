// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector/reflector.h"

#include <utility>

#include "lucerna/core/error.h"
#include "lucerna/reflector/trough_surface.h"

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

Reflector conic_trough(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture) {
  auto profile =
      std::make_shared<ConicProfile>(conic_profile(preset, focal_mm, focal2_mm, aperture.half_x_mm()));
  return {std::make_shared<TroughSurface>(std::move(profile)), aperture};
}

namespace {

std::shared_ptr<const SplineProfile> checked_profile(const std::vector<ProfileKnot>& knots, double reach_mm,
                                                     double hole_mm) {
  auto profile = std::make_shared<SplineProfile>(knots);
  if (reach_mm > profile->r_max_mm() * (1.0 + 1e-12)) {
    throw InputError(fmt::format("reflector: the profile ends at radius {} mm, the aperture reaches {} mm",
                                 profile->r_max_mm(), reach_mm));
  }
  if (profile->r_min_mm() > hole_mm * (1.0 + 1e-12)) {
    throw InputError(
        fmt::format("reflector: the profile starts at radius {} mm, the hole's radius is {} mm; "
                    "expected a profile from the axis or a hole at least as wide",
                    profile->r_min_mm(), hole_mm));
  }
  return profile;
}

}  // namespace

Reflector profile_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture) {
  return {std::make_shared<RevolutionSurface>(
              checked_profile(knots, aperture.outer_radius_mm(), aperture.hole_radius_mm())),
          aperture};
}

Reflector profile_trough(const std::vector<ProfileKnot>& knots, const Aperture& aperture) {
  return {std::make_shared<TroughSurface>(checked_profile(knots, aperture.half_x_mm(), 0.0)), aperture};
}

}  // namespace lucerna
