// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/reflector/aperture.h"
#include "lucerna/reflector/height_surface.h"
#include "lucerna/reflector/profile.h"
#include "lucerna/reflector/swept_curve.h"

namespace lucerna {

/// A mirror in its own frame: a shape and the part of it that is there.
struct Reflector {
  /// The shape; where `curve` is set, only the lowest sheet of it (CurveSheet).
  std::shared_ptr<const HeightSurface> surface;
  Aperture aperture = Aperture::circle(1.0);
  /// Set if the shape is no function of (x, y): a profile that turns back towards the axis, or has vertical
  /// parts. Then this is what is traced, within `aperture`.
  std::shared_ptr<const SweptCurve> curve = nullptr;
};

/// The lowest height of a swept curve over each place: what is left of it for whoever needs a height field
/// (drawing). Between and beyond its ends it goes on level.
class CurveSheet final : public HeightSurface {
 public:
  explicit CurveSheet(std::shared_ptr<const SweptCurve> curve);
  SurfacePoint at(double x_mm, double y_mm) const override;
  HeightRange range(const Rectangle& region) const override;

 private:
  std::shared_ptr<const SweptCurve> curve_;
};

enum class ConicPreset { parabola, ellipse, hyperbola };

/// A conic of revolution. `focal2_mm` counts for ellipse and hyperbola only. Errors as in ConicProfile.
Reflector conic_reflector(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture);

/// A surface of revolution from a spline profile. Points with ascending r, none of their chords
/// steeper than 10 : 1, make a SplineProfile; errors as there, and where the aperture is wider than the
/// profile or the profile starts outside the hole. All others make a SweptCurve, with its errors: there the
/// outer size of the aperture is either that of the last point (the mouth; the bulge behind it belongs to the
/// mirror) or holds the whole curve; a rectangle cuts it. A row of points from the rim to the axis (r
/// strictly descending) is refused.
Reflector profile_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture);

/// Troughs along y from the same profiles, over |x|. Errors alike; the aperture's half width counts as its
/// radius.
Reflector conic_trough(ConicPreset preset, double focal_mm, double focal2_mm, const Aperture& aperture);
Reflector profile_trough(const std::vector<ProfileKnot>& knots, const Aperture& aperture);

/// An ellipsoid of revolution past its equator: from the hole about its vertex to the mouth beyond the
/// equator. Light from z = focal_mm meets at z = focal2_mm; equal focal lengths make a sphere. As a
/// SweptCurve through 256 points or more: right to 1e-9 of its size. Throws InputError unless the focal
/// lengths are > 0 and the mouth is smaller than the equator.
Reflector deep_ellipse_reflector(double focal_mm, double focal2_mm, double mouth_diameter_mm,
                                 double hole_diameter_mm = 0.0);

}  // namespace lucerna
