// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "lucerna/core/direction.h"
#include "lucerna/core/frame.h"

namespace lucerna {

/// Smooth bins over directions: bilinear tents at the centres of equal cells, so that what a bin holds
/// changes continuously, and almost everywhere differentiably, with every direction. Two kinds: a square of
/// direction cosines (u, v) about an axis; and the angle gamma from the axis alone, for surfaces of
/// revolution. Light outside fades out over one cell beyond the outermost centres. Immutable, thread safe.
class TentBins {
 public:
  /// count x count bins over |u|, |v| <= half_width (0 < half_width <= 1); `axes` maps the window's frame
  /// (its z is the axis) into the frame of the directions that will be binned.
  static TentBins square(const Frame& axes, double half_width, int count);
  /// `count` bins over [0, gamma_max_rad], gamma_max <= pi.
  static TentBins rings(const Frame& axes, double gamma_max_rad, int count);

  bool is_rings() const { return rings_; }
  int count() const { return count_; }
  std::size_t size() const { return solid_angle_.size(); }
  const Frame& axes() const { return axes_; }
  /// Half width in direction cosines, or the largest gamma in radians.
  double extent() const { return extent_; }
  /// Integral of a bin's tent over solid angle, sr; 0 for squares wholly beyond the horizon.
  const std::vector<double>& solid_angle_sr() const { return solid_angle_; }

  /// Integral of intensity * tent over solid angle for every bin (8 x 8 points per cell; 64 per ring and 360
  /// around): the flux that an intensity function puts into the bins.
  std::vector<double> flux_of(const std::function<double(const Direction&)>& intensity) const;

  /// Where one direction's light goes: up to four bins with weights, and the weights' derivatives by the
  /// window's two coordinates (one for rings).
  struct Deposit {
    int n = 0;
    std::array<int, 4> bin;
    std::array<double, 4> weight, du, dv;
  };
  void deposit(const Vec3& direction, Deposit& out) const {
    out.n = 0;
    if (rings_) {
      deposit_ring(direction, out);
    } else {
      deposit_square(direction, out);
    }
  }
  /// Gradients of the window's coordinates with respect to the direction: of u and v, or of gamma.
  Vec3 gradient_u(const Vec3& direction) const {
    if (!rings_) return axes_.ex();
    const double s = length(cross(direction, axes_.ez()));
    return s > 1e-12 ? (-1.0 / s) * axes_.ez() : Vec3{};
  }
  Vec3 gradient_v() const { return axes_.ey(); }

 private:
  TentBins(bool rings, const Frame& axes, double extent, int count);
  void deposit_ring(const Vec3& direction, Deposit& out) const;
  void deposit_square(const Vec3& direction, Deposit& out) const;

  bool rings_;
  Frame axes_;
  double extent_, cell_;
  int count_;
  std::vector<double> solid_angle_;
};

}  // namespace lucerna
