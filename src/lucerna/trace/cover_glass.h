// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lucerna/reflector/aperture.h"
#include "lucerna/trace/plate_kernel.h"

namespace lucerna {

/// A flat cover glass: a plane-parallel plate that fills 0 <= z <= thickness_mm of its own frame, within a
/// circle or a rectangle about the z axis. Both faces reflect and refract by Fresnel's formulas for
/// unpolarised light; all reflections between the faces are summed (incoherent light), with what the glass
/// absorbs on the way. Light that is let through keeps its direction and leaves beside the line it came on.
/// The rim is black: light that enters or leaves through it is absorbed. Light that starts inside the plate
/// is not touched.
///
/// A ray is not split: one random number of the ray's own stream says whether it is reflected or let through,
/// a second how often it went to and fro (the light is taken as unpolarised again afterwards); what the plate
/// absorbs is taken off its flux under the cause `name`. Being let through is no reflection: it counts
/// neither towards TraceOptions::max_bounces nor makes direct light reflected light in the ledger.
struct CoverGlass {
  /// The cause in the ledger.
  std::string name = "glass";
  /// No hole.
  Aperture aperture = Aperture::circle(100.0);
  /// > 0.
  double thickness_mm = 3.0;
  /// 1 to 4. The default is soda-lime float glass in the visible.
  double refractive_index = 1.52;
  /// Natural absorption coefficient >= 0: a path of x mm leaves exp(-x * absorption_per_mm).
  double absorption_per_mm = 0.0;
  Frame world_from_glass;
};

/// Throws InputError naming the number that is out of its range.
void check(const CoverGlass& glass);

/// What a plate returns, lets through and keeps of unpolarised light; they sum to 1. `cos_incidence` in
/// [0, 1], outside the glass.
struct GlassShares {
  double reflected = 0.0, transmitted = 0.0, absorbed = 0.0;
};
GlassShares glass_shares(const CoverGlass& glass, double cos_incidence);

/// Rays through a set of cover glasses. Immutable and thread safe.
class GlassTracer {
 public:
  /// Throws InputError as `check` does.
  explicit GlassTracer(const std::vector<CoverGlass>& glasses);

  bool empty() const { return plates_.empty(); }
  /// As kernels read them.
  const std::vector<PlacedPlate>& plates() const { return plates_; }

  /// The first plate within [0, t_max_mm) of a ray in the luminaire frame. O(plates).
  std::optional<GlassHit> first_hit(const Ray& ray, double t_max_mm) const {
    return first_plate(plates_.data(), plates_.size(), ray, t_max_mm);
  }

  /// What becomes of the ray there. `key.bounce` counts all that the ray met before, plates included.
  GlassPassage pass(const Ray& ray, const GlassHit& hit, const ReflectionKey& key) const {
    return through_plate(plates_[hit.glass], ray, hit, key);
  }

 private:
  std::vector<PlacedPlate> plates_;
};

}  // namespace lucerna
