// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "lucerna/trace/kernels/cover_glass_kernel.h"

namespace lucerna {

/// Rays through cover glasses and clear bodies; the bodies' numbers follow the glasses'. Immutable and thread
/// safe.
class GlassTracer {
 public:
  /// Throws InputError as `check` does.
  explicit GlassTracer(const std::vector<CoverGlass>& glasses, const std::vector<Solid>& solids = {});

  bool empty() const { return cover_glasses_.empty() && solids_.empty(); }
  /// As kernels read them.
  const std::vector<PlacedCoverGlass>& cover_glasses() const { return cover_glasses_; }

  /// The first plate or body within [0, t_max_mm) of a ray in the luminaire frame; `started`: the ray met
  /// something before. O(plates) and some hundred ns for bodies.
  std::optional<GlassHit> first_hit(const Ray& ray, double t_max_mm, bool started) const;

  /// What becomes of the ray there. `key.bounce` counts all that the ray met before, plates and bodies
  /// included. `wavelength_nm` counts in bodies that disperse; not above 0: not known. `visit` sees every
  /// point of a body's surface on the way.
  GlassPassage pass(const Ray& ray, const GlassHit& hit, const ReflectionKey& key, float wavelength_nm,
                    const std::function<void(const Vec3&)>& visit = {}) const {
    if (is_solid(hit)) {
      GlassHit of_solid = hit;
      of_solid.glass -= cover_glasses_.size();
      return solids_.pass(ray, of_solid, key, wavelength_nm, visit);
    }
    return through_cover_glass(cover_glasses_[hit.glass], ray, hit, key);
  }

  /// The same of many rays; `t_max_mm` becomes how far away the hits are.
  void first_hits(std::span<const Ray> rays, bool started, std::span<double> t_max_mm,
                  std::span<std::optional<GlassHit>> hits) const;
  void pass(std::span<const GlassRay> rays, std::span<GlassPassage> out) const;

  bool is_solid(const GlassHit& hit) const { return hit.glass >= cover_glasses_.size(); }

 private:
  std::vector<PlacedCoverGlass> cover_glasses_;
  SolidTracer solids_;
};

}  // namespace lucerna
