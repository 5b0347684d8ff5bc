// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/glass_tracer.h"

#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

CoverGlassView view_of(const CoverGlass& g) {
  return {g.aperture.shape() == ApertureShape::circle,
          g.aperture.half_x_mm(),
          g.aperture.half_y_mm(),
          g.thickness_mm,
          g.refractive_index,
          g.absorption_per_mm};
}

}  // namespace

void check(const CoverGlass& glass) {
  const auto need = [&](bool good, const char* what, double value, const char* expected) {
    if (!good) {
      throw InputError(
          fmt::format("cover glass '{}': {} is {}, expected {}", glass.name, what, value, expected));
    }
  };
  const double d = glass.thickness_mm, n = glass.refractive_index, a = glass.absorption_per_mm;
  need(d > 0.0 && std::isfinite(d), "thickness_mm", d, "a finite number above 0");
  need(n >= 1.0 && n <= 4.0, "refractive_index", n, "1 to 4");
  need(a >= 0.0 && std::isfinite(a), "absorption_per_mm", a, "a finite number >= 0");
  const double hole = 2.0 * glass.aperture.hole_radius_mm();
  need(hole == 0.0, "hole_diameter_mm", hole, "none: a cover glass has no hole");
}

GlassShares glass_shares(const CoverGlass& glass, double cos_incidence) {
  const CoverGlassAtAngle at = cover_glass_at_angle(view_of(glass), cos_incidence);
  const double r = 0.5 * (at.s.reflected + at.p.reflected), t = 0.5 * (at.s.transmitted + at.p.transmitted);
  return {r, t, 1.0 - r - t};
}

GlassTracer::GlassTracer(const std::vector<CoverGlass>& glasses, const std::vector<Solid>& solids)
    : solids_(solids) {
  for (const CoverGlass& g : glasses) {
    check(g);
    cover_glasses_.push_back({view_of(g), g.world_from_glass, g.world_from_glass.inverse()});
  }
}

std::optional<GlassHit> GlassTracer::first_hit(const Ray& ray, double t_max_mm, bool started) const {
  const auto plate = first_cover_glass(cover_glasses_.data(), cover_glasses_.size(), ray, t_max_mm);
  auto solid = solids_.first_hit(ray, plate ? plate->t_mm : t_max_mm, started);
  if (!solid) return plate;
  solid->glass += cover_glasses_.size();
  return solid;
}

}  // namespace lucerna
