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

void GlassTracer::first_hits(std::span<const Ray> rays, bool started, std::span<double> t_max_mm,
                             std::span<std::optional<GlassHit>> hits) const {
  for (std::size_t i = 0; i < rays.size(); ++i) hits[i].reset();
  solids_.first_hits(rays, started, t_max_mm, hits);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    if (hits[i]) hits[i]->glass += cover_glasses_.size();
    const auto plate = first_cover_glass(cover_glasses_.data(), cover_glasses_.size(), rays[i], t_max_mm[i]);
    if (!plate) continue;
    hits[i] = plate;
    t_max_mm[i] = plate->t_mm;
  }
}

void GlassTracer::pass(std::span<const GlassRay> rays, std::span<GlassPassage> out) const {
  for (std::size_t i = 0; !cover_glasses_.empty() && i < rays.size(); ++i) {
    const GlassRay& r = rays[i];
    if (!is_solid(r.hit)) out[i] = through_cover_glass(cover_glasses_[r.hit.glass], r.ray, r.hit, r.key);
  }
  solids_.pass(rays, cover_glasses_.size(), out);
}

}  // namespace lucerna
