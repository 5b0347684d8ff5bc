// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

// The last face of a lens as a free form: what stays a body of revolution below it, and the face itself as a
// design sees it. A design's frame is the lens's turned about x: light goes down to the face, as it does to a
// mirror.

/// The lens without its free face: the corners from the axis, or from a bottom face's rim, to the upper end
/// of the wall.
struct FaceSeat {
  std::vector<OutlinePoint> below_mm;
  /// In straight pieces, without walls.
  std::vector<OutlineSide> base;
  /// The first face, where that is a free form too, in a design's frame.
  std::optional<DesignShape> bottom = std::nullopt;
  double radius_mm() const { return below_mm.back()[0]; }
  double lowest_mm() const;
  /// Of what is below the face, in the lens's frame, at a place of a design's.
  double height_mm(double x_mm, double y_mm = 0.0) const;
};

/// The seat of the one free face of a lens, which leads from the upper end of a wall along the axis to the
/// axis. Throws InputError for any other.
FaceSeat face_seat(const LensShape& lens);

/// The seat of a lens's last face: of one free face, or over another.
FaceSeat seat_of(const ShapedLens& lens);

/// The free face of the lens as it is, in a design's frame. Throws InputError where it is not a height over
/// every place.
DesignShape face_of(const LensShape& lens, int intervals, ShapeSymmetry symmetry = ShapeSymmetry::none);

Frame lens_from_design();

/// Brings rays of a design into the lens: by the first face that they meet. Rays that meet none, or the free
/// face from outside, are lost.
DesignRays::Pass into_lens(const LensShape& lens, const MediumView& medium);

/// A face as a bicubic spline in the lens's frame: over [-half, half] along both sides, row by row.
struct FaceSpline {
  int intervals_x = 1, intervals_y = 1;
  double half_mm = 1.0;
  std::vector<double> coefficients_mm;
};
FaceSpline face_spline(const DesignShape& face);

/// Circles on which a face is compared with its limits, and twice as many radii: while it is fitted, and as
/// the result is judged.
inline constexpr int kFitRings = 48, kCheckRings = 100;

/// How far straight pieces may leave the curves below a face.
inline constexpr double kBaseTolerance_mm = 1e-4;

/// Limits on a face of this radius: the draft, and heights that `bounds_at` says for a place, on so many
/// circles.
ShapeLimits limits_on_circles(const LensLimits& limits, const DesignShape& face, double radius_mm, int rings,
                              const std::function<HeightBounds(double x_mm, double y_mm)>& bounds_at);

/// The limits on a lens as those on its free face, on so many circles.
ShapeLimits face_limits(const LensLimits& limits, const FaceSeat& seat, const DesignShape& start, int rings);

/// The face with its heights bent to what the limits allow, over about a step between knots.
DesignShape within_limits(const LensLimits& limits, const FaceSeat& seat, const DesignShape& face);

/// Every limit that is set, as found on a fine grid.
std::vector<LimitCheck> check_face_limits(const LensLimits& limits, const FaceSeat& seat,
                                          const DesignShape& face);

/// The lens with a face: what `trace` takes.
Solid with_face(const Solid& solid, const FaceSeat& seat, const DesignShape& face);

}  // namespace lucerna
