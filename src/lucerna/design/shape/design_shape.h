// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <variant>
#include <vector>

#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/reflector.h"

namespace lucerna {

/// Symmetries that a free-form shape may be held to, in the mirror's frame. `trough`: the same for every y;
/// `trough_mirror_x`: and mirrored.
enum class ShapeSymmetry { none, mirror_y, mirror_x, both, trough, trough_mirror_x };

/// A mirror with free parameters: one of the smooth families, its aperture, and which coefficients are tied
/// together. Parameters are heights in mm off a base paraboloid, at most 1000 or so are sensible. A value;
/// cheap to copy.
class DesignShape {
 public:
  /// Surface of revolution over a circular aperture with `intervals` knot intervals from the axis to the rim:
  /// intervals + 2 parameters, all 0 at first (the paraboloid). Throws InputError for a focal length or a
  /// count out of range (1 <= intervals <= 1000), or an aperture that is not a circle.
  static DesignShape revolution(double focal_mm, const Aperture& aperture, int intervals);
  /// Free form over the aperture's bounds with intervals_x by intervals_y knot intervals: (intervals_x + 3) *
  /// (intervals_y + 3) coefficients, fewer parameters with a symmetry. Throws InputError as above (1 <=
  /// intervals <= 60).
  static DesignShape bspline(double focal_mm, const Aperture& aperture, int intervals_x, int intervals_y,
                             ShapeSymmetry symmetry = ShapeSymmetry::none);

  /// Trough z = x^2 / (4 f) + s(x) over the aperture's bounds, s a spline with `intervals` knot intervals:
  /// intervals + 3 parameters, about half with `mirrored`. A bicubic patch in its family, whose coefficients
  /// are one parameter for each x, less the paraboloid's y^2 / (4 f). Throws InputError as above.
  static DesignShape trough(double focal_mm, const Aperture& aperture, int intervals, bool mirrored = false);

  bool is_trough() const {
    return symmetry_ == ShapeSymmetry::trough || symmetry_ == ShapeSymmetry::trough_mirror_x;
  }
  bool is_revolution() const { return std::holds_alternative<RevolutionShape>(shape_); }
  const std::variant<RevolutionShape, BsplineShape>& family() const { return shape_; }
  const Aperture& aperture() const { return aperture_; }
  double focal_mm() const;
  /// What lengths are measured by: the aperture's outer radius; of a trough half its width.
  double radius_mm() const { return is_trough() ? aperture_.half_x_mm() : aperture_.outer_radius_mm(); }
  ShapeSymmetry symmetry() const { return symmetry_; }

  std::size_t parameter_count() const { return static_cast<std::size_t>(parameters_.size()); }
  const Eigen::VectorXd& parameters() const { return parameters_; }
  /// The same family with other values. `parameters` must have parameter_count() entries.
  DesignShape with(const Eigen::VectorXd& parameters) const;
  /// Which parameter each coefficient of the family is.
  const std::vector<int>& parameter_of() const { return parameter_of_; }

  /// The same family through other heights (mm over the mirror's frame), agreeing with them at the knots'
  /// averages (Greville points, one step beyond the edges too).
  DesignShape through(const std::function<double(double x, double y)>& height_mm) const;
  /// Maximum minus minimum height over the aperture, sampled on 101 x 101 points and the rims.
  double height_mm() const;

  /// The same surface on other knots. Exact (to rounding) where the new knots contain the old ones, as when
  /// intervals are doubled; else the spline that agrees at the new knots' averages (Greville points).
  DesignShape refined(int intervals_x, int intervals_y) const;
  /// Knot intervals along x (or r) and y (0 for revolution).
  int intervals_x() const;
  int intervals_y() const;

  /// The surface itself, for tracers and CAD.
  std::shared_ptr<const HeightSurface> surface() const;
  Reflector reflector() const { return {surface(), aperture_}; }
  /// Height over the mirror's frame and both slopes.
  SurfacePoint at(double x_mm, double y_mm) const;

 private:
  DesignShape(std::variant<RevolutionShape, BsplineShape> shape, const Aperture& aperture,
              ShapeSymmetry symmetry);
  std::vector<double> coefficients() const;

  std::variant<RevolutionShape, BsplineShape> shape_;
  Aperture aperture_;
  ShapeSymmetry symmetry_;
  std::vector<int> parameter_of_;
  /// What each coefficient is above its parameter.
  std::vector<double> above_;
  Eigen::VectorXd parameters_;
};

}  // namespace lucerna
