// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "lucerna/reflector.h"

namespace lucerna {

/// Height and slope of a profile at one distance from the axis.
struct ProfilePoint {
  double z_mm = 0.0;
  double slope = 0.0;
};

/// A curve z = p(r), r >= 0, that a surface of revolution or a trough is made of. Beyond `r_max_mm` (and,
/// where it starts off the axis, below `r_min_mm`) it continues along its tangent. Immutable and thread safe.
class Profile {
 public:
  virtual ~Profile() = default;
  virtual ProfilePoint at(double r_mm) const = 0;
  /// Exact range of heights over [r0, r1], 0 <= r0 <= r1.
  virtual HeightRange range(double r0_mm, double r1_mm) const = 0;
  /// True if the slope, for all r >= 0, is never negative and never falls: what it sweeps is convex.
  virtual bool convex() const = 0;
  double r_min_mm() const { return r_min_mm_; }
  double r_max_mm() const { return r_max_mm_; }

 protected:
  double r_min_mm_ = 0.0, r_max_mm_ = 0.0;
};

/// A conic section with its vertex at the origin: z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2)), c the
/// curvature at the vertex, k the conic constant (ISO 10110-12).
class ConicProfile final : public Profile {
 public:
  /// All light from z = focal_mm leaves along +z. Throws InputError unless focal_mm > 0.
  static ConicProfile parabola(double focal_mm, double r_max_mm);
  /// Light from z = focal_mm meets at z = focal2_mm. Throws InputError unless both are > 0 and r_max_mm is
  /// inside the equator sqrt(focal_mm * focal2_mm), where the profile stops being a function of the radius.
  static ConicProfile ellipse(double focal_mm, double focal2_mm, double r_max_mm);
  /// Light from z = focal_mm leaves as if from z = -focal2_mm. Throws InputError unless 0 < focal_mm <
  /// focal2_mm.
  static ConicProfile hyperbola(double focal_mm, double focal2_mm, double r_max_mm);

  ProfilePoint at(double r_mm) const override;
  HeightRange range(double r0_mm, double r1_mm) const override;
  bool convex() const override { return curvature_ >= 0.0; }

  double curvature_per_mm() const { return curvature_; }
  double conic_constant() const { return conic_; }

 private:
  ConicProfile(double curvature, double conic, double r_max_mm);
  double curvature_, conic_;
  double tangent_from_mm_;
};

/// The cubic spline with continuous curvature (C2) through given points. A profile that starts on the axis (r
/// = 0) has slope 0 there, so that the surface is smooth; the other ends are not-a-knot (C. de Boor, "A
/// Practical Guide to Splines", ch. IV). Two points make a line, or from the axis a parabola.
class SplineProfile final : public Profile {
 public:
  /// Throws InputError unless there are at least two points, all finite, with r >= 0 strictly ascending.
  explicit SplineProfile(const std::vector<ProfileKnot>& knots);

  /// O(log knots).
  ProfilePoint at(double r_mm) const override;
  HeightRange range(double r0_mm, double r1_mm) const override;
  bool convex() const override { return convex_; }

 private:
  /// z = z + t (b + t (c + t d)) with t = r - r_mm.
  struct Piece {
    double r_mm, z, b, c, d;
  };
  const Piece& piece(double r_mm) const;
  std::vector<Piece> pieces_;
  /// Tangents begin below and above these.
  double formula_from_mm_ = 0.0, formula_to_mm_ = 0.0;
  bool convex_ = false;
};

/// The surface that a profile sweeps about the z axis.
class RevolutionSurface final : public HeightSurface {
 public:
  explicit RevolutionSurface(std::shared_ptr<const Profile> profile);
  SurfacePoint at(double x_mm, double y_mm) const override;
  HeightRange range(const Rectangle& region) const override;
  bool convex_over(const Rectangle&) const override { return profile_->convex(); }
  const Profile& profile() const { return *profile_; }

 private:
  std::shared_ptr<const Profile> profile_;
};

}  // namespace lucerna
