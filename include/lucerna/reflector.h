// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/host_device.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Height and exact gradient of a surface z = h(x, y) at one place.
struct SurfacePoint {
  /// Height.
  double z_mm = 0.0;
  /// Gradient.
  double dzdx = 0.0, dzdy = 0.0;
};

/// A closed range of heights.
struct HeightRange {
  /// Both belong to it.
  double low_mm = 0.0, high_mm = 0.0;
};

/// An axis-parallel rectangle in the reflector's xy plane.
struct Rectangle {
  /// Its sides; x0_mm <= x1_mm, y0_mm <= y1_mm.
  double x0_mm = 0.0, x1_mm = 0.0, y0_mm = 0.0, y1_mm = 0.0;
};

/// The shape of a mirror as a height over the xy plane of its own frame: vertex at the origin, opening along
/// +z; the side towards +z reflects. Defined for every (x, y): beyond the region that it describes it
/// continues steadily, so that cells cut by an aperture's rim have heights. Immutable and thread safe.
class HeightSurface {
 public:
  virtual ~HeightSurface() = default;

  /// Height and gradient at (x, y).
  virtual SurfacePoint at(double x_mm, double y_mm) const = 0;

  /// A range that holds the height at every point of `region`; as tight as is cheap. What hierarchies are
  /// built from.
  virtual HeightRange range(const Rectangle& region) const = 0;

  /// True only where the height is known to be convex, with a gradient that is continuous up to the next
  /// region: a line crosses a bowl twice at most. False, as here, costs time and not accuracy.
  virtual bool convex_over(const Rectangle& region) const;
};

/// The height fields that close a body: above, and below where it has one there.
struct BodyFaces {
  /// At the top.
  const HeightSurface& top;
  /// Null for a body whose bottom is a surface of revolution.
  const HeightSurface* bottom = nullptr;
};

/// The same lenslet over every cell of a square or hexagonal grid about the z axis, one of them on the axis.
struct LensArray {
  /// Distance of neighbouring centres, > 0.
  double pitch_mm = 1.0;
  /// Rows of every other cell are moved by half a pitch.
  bool is_hexagonal = false;
  /// Of curvature at the apex, not 0; above 0 lenslets bulge towards +z, below 0 they are hollow.
  double radius_mm = 1.0;
  /// 0: a sphere; -1: a paraboloid.
  double conic = 0.0;
  /// Height of all apexes.
  double apex_mm = 0.0;
};
/// Its surface, as the face of a `Solid`. Throws InputError for what is not finite or out of its range, and
/// for lenslets that end within their cells.
[[nodiscard]] std::shared_ptr<const HeightSurface> lens_array(const LensArray& array);

/// The outlines that an aperture can have.
enum class ApertureShape { circle, rectangle };

/// The part of a height surface that is there: a circle or a rectangle about the z axis, less a round hole
/// for the lamp.
class Aperture {
 public:
  /// Throws InputError unless diameter > 0 and 0 <= hole < diameter.
  [[nodiscard]] static Aperture circle(double diameter_mm, double hole_diameter_mm = 0.0);
  /// Throws InputError unless both sizes are > 0 and 0 <= hole < the smaller of them.
  [[nodiscard]] static Aperture rectangle(double size_x_mm, double size_y_mm, double hole_diameter_mm = 0.0);

  /// True if (x, y) is on the mirror; outer rims belong to it, the hole's rim does too.
  bool contains(double x_mm, double y_mm) const {
    const double r2 = x_mm * x_mm + y_mm * y_mm;
    if (r2 < hole_radius_mm_ * hole_radius_mm_) return false;
    if (shape_ == ApertureShape::circle) return r2 <= half_x_mm_ * half_x_mm_;
    return x_mm <= half_x_mm_ && x_mm >= -half_x_mm_ && y_mm <= half_y_mm_ && y_mm >= -half_y_mm_;
  }

  /// The smallest rectangle about it.
  Rectangle bounds() const { return {-half_x_mm_, half_x_mm_, -half_y_mm_, half_y_mm_}; }
  /// Distance of its farthest point from the axis.
  double outer_radius_mm() const;
  /// Radius of the hole; 0 without one.
  LUCERNA_HD double hole_radius_mm() const { return hole_radius_mm_; }
  /// Radius of a circle, half the size of a rectangle along x.
  LUCERNA_HD double half_x_mm() const { return half_x_mm_; }
  /// Radius of a circle, half the size of a rectangle along y.
  LUCERNA_HD double half_y_mm() const { return half_y_mm_; }
  /// Circle or rectangle.
  LUCERNA_HD ApertureShape shape() const { return shape_; }

  /// True if no point of `region` is on the mirror.
  bool misses(const Rectangle& region) const;

 private:
  Aperture(ApertureShape shape, double half_x_mm, double half_y_mm, double hole_radius_mm);
  ApertureShape shape_;
  double half_x_mm_, half_y_mm_, hole_radius_mm_;
};

/// Minimum and maximum distance from the origin to points of `region`.
struct RadiusRange {
  /// Of the nearest and of the farthest point, mm.
  double min_mm = 0.0, max_mm = 0.0;
};
/// The minimum and maximum distance of `region`'s points from the origin.
RadiusRange radius_range(const Rectangle& region);

/// One given point of a spline profile.
struct ProfileKnot {
  /// Distance from the axis, and height.
  double r_mm = 0.0, z_mm = 0.0;
};

/// A profile that is no function of the radius; opaque to users of the library.
class SweptCurve;

/// A mirror in its own frame: a shape and the part of it that is there.
struct Reflector {
  /// The shape; where `curve` is set, only the lowest sheet of it (CurveSheet).
  std::shared_ptr<const HeightSurface> surface;
  /// The part of the shape that is there.
  Aperture aperture = Aperture::circle(1.0);
  /// Set if the shape is no function of (x, y): a profile that turns back towards the axis, or has vertical
  /// parts. Then this is what is traced, within `aperture`.
  std::shared_ptr<const SweptCurve> curve = nullptr;
};

/// The conics of revolution that are made from focal lengths.
enum class ConicPreset { parabola, ellipse, hyperbola };

/// A conic of revolution. `focal2_mm` counts for ellipse and hyperbola only. Errors as in ConicProfile.
[[nodiscard]] Reflector conic_reflector(ConicPreset preset, double focal_mm, double focal2_mm,
                                        const Aperture& aperture);

/// A surface of revolution from a spline profile. Points with ascending r, none of their chords
/// steeper than 10 : 1, make a SplineProfile; errors as there, and where the aperture is wider than the
/// profile or the profile starts outside the hole. All others make a SweptCurve, with its errors: there the
/// outer size of the aperture is either that of the last point (the mouth; the bulge behind it belongs to the
/// mirror) or holds the whole curve; a rectangle cuts it. A row of points from the rim to the axis (r
/// strictly descending) is refused.
[[nodiscard]] Reflector profile_reflector(const std::vector<ProfileKnot>& knots, const Aperture& aperture);

/// A trough along y with a conic as its profile. The aperture's half width along x counts as its radius;
/// errors as `conic_reflector`.
[[nodiscard]] Reflector conic_trough(ConicPreset preset, double focal_mm, double focal2_mm,
                                     const Aperture& aperture);
/// A trough along y with a spline profile over |x|; errors as `profile_reflector`.
[[nodiscard]] Reflector profile_trough(const std::vector<ProfileKnot>& knots, const Aperture& aperture);

/// An ellipsoid of revolution past its equator: from the hole about its vertex to the mouth beyond the
/// equator. Light from z = focal_mm meets at z = focal2_mm; equal focal lengths make a sphere. As a
/// SweptCurve through 256 points or more: right to 1e-9 of its size. Throws InputError unless the focal
/// lengths are > 0 and the mouth is smaller than the equator.
[[nodiscard]] Reflector deep_ellipse_reflector(double focal_mm, double focal2_mm, double mouth_diameter_mm,
                                               double hole_diameter_mm = 0.0);

}  // namespace lucerna
#pragma GCC visibility pop
