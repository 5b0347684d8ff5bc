// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/geometry.h"
#include "lucerna/source.h"

namespace lucerna {

/// Light on one line: where its rays start, and how much there is.
struct LineLight {
  /// Distance to the start along the ray that was asked for; negative if it lies behind the ray's origin.
  double start_mm = 0.0;
  /// Luminance over the flux of the source, 1/(mm^2 sr); > 0.
  double pdf_etendue = 0.0;
};

/// A ball.
struct LightBound {
  Vec3 centre_mm;
  double radius_mm = 0.0;
};

/// What a RaySource is as well if it knows its luminance on any line: then light can be followed backward,
/// from where it arrives to where it starts. Immutable and thread safe.
class LuminanceSource {
 public:
  virtual ~LuminanceSource() = default;

  /// False if the rays fill no étendue (rays through one point or line, or parallel); the other functions
  /// must not be called then.
  virtual bool has_luminance() const = 0;

  /// Appends to `to` the light that runs along the line of `ray`, in its direction. The rays that `emit`
  /// draws have this density, and start there.
  virtual void add_light_on(const Ray& ray, std::vector<LineLight>& to) const = 0;

  /// A ball that every line of light crosses.
  virtual LightBound light_bound() const = 0;
};

/// The source as one that knows its luminance; null where it does not.
inline const LuminanceSource* luminance_of(const RaySource& source) {
  const auto* light = dynamic_cast<const LuminanceSource*>(&source);
  return light != nullptr && light->has_luminance() ? light : nullptr;
}

}  // namespace lucerna
