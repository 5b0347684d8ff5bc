// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace/kernels/cover_glass_kernel.h"

namespace lucerna {

/// Rays through a set of cover glasses. Immutable and thread safe.
class GlassTracer {
 public:
  /// Throws InputError as `check` does.
  explicit GlassTracer(const std::vector<CoverGlass>& glasses);

  bool empty() const { return cover_glasses_.empty(); }
  /// As kernels read them.
  const std::vector<PlacedCoverGlass>& cover_glasses() const { return cover_glasses_; }

  /// The first plate within [0, t_max_mm) of a ray in the luminaire frame. O(plates).
  std::optional<GlassHit> first_hit(const Ray& ray, double t_max_mm) const {
    return first_cover_glass(cover_glasses_.data(), cover_glasses_.size(), ray, t_max_mm);
  }

  /// What becomes of the ray there. `key.bounce` counts all that the ray hit before, plates included.
  GlassPassage pass(const Ray& ray, const GlassHit& hit, const ReflectionKey& key) const {
    return through_cover_glass(cover_glasses_[hit.glass], ray, hit, key);
  }

 private:
  std::vector<PlacedCoverGlass> cover_glasses_;
};

}  // namespace lucerna
