// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lucerna/core/direction.h"
#include "lucerna/core/frame.h"

namespace lucerna {

/// Smooth bins over the light that leaves: bilinear tents at the centres of equal cells, so that what a bin
/// holds changes continuously, and almost everywhere differentiably, with every ray. Four kinds: a square of
/// direction cosines (u, v) about an axis; the angle gamma from the axis alone, for surfaces of revolution; a
/// rectangle of a plane that the light falls on; and a zone of (gamma, C) about an axis, for limits on glare.
/// Light outside fades out over one cell beyond the outermost centres. Immutable, thread safe.
class TentBins {
 public:
  /// count x count bins over |u|, |v| <= half_width (0 < half_width <= 1); `axes` maps the window's frame
  /// (its z is the axis) into the frame of the directions that will be binned.
  static TentBins square(const Frame& axes, double half_width, int count);
  /// `count` bins over [0, gamma_max_rad], gamma_max <= pi.
  static TentBins rings(const Frame& axes, double gamma_max_rad, int count);
  /// count x count bins over |x| <= half_x_mm, |y| <= half_y_mm of the xy plane of `axes`; light counts that
  /// falls on the side its z points to. `widen` scales both.
  static TentBins plane(const Frame& axes, double half_x_mm, double half_y_mm, int count, double widen = 1.0);
  /// `rings` x `sectors` bins over gamma in [gamma_min_rad, pi] and all C (from x towards y of `axes`); the
  /// outermost tents end where the zone ends. 0 <= gamma_min < pi.
  static TentBins zone(const Frame& axes, double gamma_min_rad, int rings, int sectors);

  bool is_rings() const { return kind_ == Kind::rings; }
  bool is_plane() const { return kind_ == Kind::plane; }
  int count() const { return count_; }
  std::size_t size() const { return measure_.size(); }
  const Frame& axes() const { return axes_; }
  /// Half width in direction cosines, the largest gamma in radians, or what a plane was widened by.
  double extent() const { return extent_; }
  double half_x_mm() const { return half_x_mm_; }
  double half_y_mm() const { return half_y_mm_; }
  /// Integral of a bin's tent over solid angle in sr, or over the plane's area in mm2; 0 for squares wholly
  /// beyond the horizon.
  const std::vector<double>& measure() const { return measure_; }

  /// Integral of intensity * tent over solid angle for every bin (8 x 8 points per cell; 64 per ring and 360
  /// around): the flux that an intensity function puts into the bins. Not for planes.
  std::vector<double> flux_of(const std::function<double(const Direction&)>& intensity) const;
  /// Integral of a density over (x, y) in mm * tent over the plane's area in mm2 (8 x 8 points per cell).
  std::vector<double> flux_on(const std::function<double(double x_mm, double y_mm)>& density_per_mm2) const;

  /// Where one ray's light goes: up to four bins with weights, and the weights' derivatives by the window's
  /// two coordinates (one for rings).
  struct Deposit {
    int n = 0;
    std::array<int, 4> bin;
    std::array<double, 4> weight, du, dv;
  };
  /// Of a ray that leaves `origin` along the unit vector `direction`; the origin counts for planes only.
  void deposit(const Vec3& origin, const Vec3& direction, Deposit& out) const {
    out.n = 0;
    switch (kind_) {
      case Kind::rings:
        return deposit_ring(direction, out);
      case Kind::square:
        return deposit_square(direction, out);
      case Kind::plane:
        return deposit_plane(origin, direction, out);
      case Kind::zone:
        return deposit_zone(direction, out);
    }
  }
  /// Gradients of the window's coordinates with respect to a ray's direction and start.
  struct Gradient {
    Vec3 direction, origin;
  };
  /// Of the first coordinate: u, x or gamma.
  Gradient gradient_u(const Vec3& origin, const Vec3& direction) const;
  /// Of the second: v, y or C. Not for rings.
  Gradient gradient_v(const Vec3& origin, const Vec3& direction) const;

 private:
  enum class Kind { square, rings, plane, zone };
  TentBins(Kind kind, const Frame& axes, double extent, int count);
  void deposit_ring(const Vec3& direction, Deposit& out) const;
  void deposit_square(const Vec3& direction, Deposit& out) const;
  void deposit_plane(const Vec3& origin, const Vec3& direction, Deposit& out) const;
  void deposit_zone(const Vec3& direction, Deposit& out) const;
  /// Tents of the grid of count_ x count_ cells over |u|, |v| <= extent_.
  void deposit_grid(double u, double v, Deposit& out) const;
  Gradient across_plane(const Vec3& origin, const Vec3& direction, const Vec3& axis, double half) const;

  Kind kind_;
  Frame axes_;
  double extent_, cell_;
  int count_;
  double half_x_mm_ = 1.0, half_y_mm_ = 1.0;  // plane
  double gamma_min_ = 0.0, sector_ = 1.0;     // zone
  int sectors_ = 1;
  std::vector<double> measure_;
};

}  // namespace lucerna
