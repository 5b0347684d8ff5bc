// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <memory>

#include "lucerna/reflector.h"

namespace lucerna {

/// One facet: height and slope at its centre.
struct Facet {
  double z_mm, dzdx, dzdy;
};

/// A base surface cut into square facets on a grid about the axis. Each facet touches the base at its centre,
/// with the base's slope there, and is flat, or a pillow: a paraboloid cap of its own radius of curvature.
/// Heights step where facets meet; a ray goes through such a step as if the wall were not there.
class FacetedSurface final : public HeightSurface {
 public:
  /// `pitch_mm` > 0; `pillow_radius_mm` not 0: positive bulges towards the light, negative is hollow;
  /// infinite = flat. Throws InputError otherwise.
  FacetedSurface(std::shared_ptr<const HeightSurface> base, double pitch_mm, double pillow_radius_mm);

  SurfacePoint at(double x_mm, double y_mm) const override;
  HeightRange range(const Rectangle& region) const override;

  /// Side of a facet; facet (i, j) lies over [i pitch, (i + 1) pitch] x [j pitch, (j + 1) pitch].
  double pitch_mm() const { return pitch_mm_; }
  /// Second derivative of a facet's height along any line: 0 for flat ones.
  double curvature_per_mm() const { return curvature_; }
  Facet facet(std::int32_t i, std::int32_t j) const;

 private:
  std::shared_ptr<const HeightSurface> base_;
  double pitch_mm_, curvature_;
};

}  // namespace lucerna
