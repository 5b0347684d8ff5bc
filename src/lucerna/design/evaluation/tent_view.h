// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lucerna/design/evaluation/tent_axis.h"
#include "lucerna/geometry.h"
#include "lucerna/host_device.h"

namespace lucerna {

enum class TentKind : std::int32_t { square, rings, plane, zone };

/// Where one ray's light goes: up to four bins with weights, and the weights' derivatives by the window's two
/// coordinates (one for rings).
struct TentDeposit {
  int n = 0;
  std::array<int, 4> bin;
  std::array<double, 4> weight, du, dv;
};

/// Gradients of a window's coordinate with respect to a ray's direction and start.
struct TentGradient {
  Vec3 direction, origin;
};

/// The bins of tent_bins.h as CPU and GPU read them.
struct TentBinsView {
  TentKind kind = TentKind::square;
  Frame axes;
  /// Half width in direction cosines, the largest gamma (of a zone its width) in radians, or what a plane was
  /// widened by.
  double extent = 1.0;
  double cell = 1.0;
  int count = 2;
  TentAxis axis_u, axis_v;                     // square and plane
  double half_x_mm = 1.0, half_y_mm = 1.0;     // plane
  double gamma_min = 0.0, sector_width = 1.0;  // zone
  int sectors = 1;

  LUCERNA_HD bool is_rings() const { return kind == TentKind::rings; }
  LUCERNA_HD int size() const {
    return is_rings() ? count : kind == TentKind::zone ? count * sectors : count * count;
  }

  /// Of a ray that leaves `origin` along the unit vector `direction`; the origin counts for planes only.
  LUCERNA_HD void deposit(const Vec3& origin, const Vec3& direction, TentDeposit& out) const {
    out.n = 0;
    switch (kind) {
      case TentKind::rings:
        return deposit_ring(direction, out);
      case TentKind::square:
        return deposit_square(direction, out);
      case TentKind::plane:
        return deposit_plane(origin, direction, out);
      case TentKind::zone:
        return deposit_zone(direction, out);
    }
  }

  /// Of the first coordinate: u, x or gamma.
  LUCERNA_HD TentGradient gradient_u(const Vec3& origin, const Vec3& direction) const {
    if (kind == TentKind::square) return {axes.ex(), {}};
    if (kind == TentKind::plane) return across_plane(origin, direction, axes.ex(), half_x_mm);
    const double s = length(cross(direction, axes.ez()));
    return {s > 1e-12 ? (-1.0 / s) * axes.ez() : Vec3{}, {}};
  }
  /// Of the second: v, y or C. Not for rings.
  LUCERNA_HD TentGradient gradient_v(const Vec3& origin, const Vec3& direction) const {
    if (kind == TentKind::square) return {axes.ey(), {}};
    if (kind == TentKind::plane) return across_plane(origin, direction, axes.ey(), half_y_mm);
    const double x = dot(direction, axes.ex()), y = dot(direction, axes.ey());
    const double square = x * x + y * y;
    if (square < 1e-24) return {};
    return {(x / square) * axes.ey() - (y / square) * axes.ex(), {}};
  }

  LUCERNA_HD void deposit_ring(const Vec3& direction, TentDeposit& out) const {
    const double c = dot(direction, axes.ez());
    const double gamma = std::atan2(length(cross(direction, axes.ez())), c);
    const double s = gamma / cell - 0.5;
    if (s < 0.0) {  // the innermost bin is flat at the axis
      out.n = 1;
      out.bin[0] = 0;
      out.weight[0] = 1.0;
      out.du[0] = out.dv[0] = 0.0;
      return;
    }
    if (s >= count) return;
    const int i = static_cast<int>(s);
    const double f = s - i;
    out.bin[0] = i;
    out.weight[0] = 1.0 - f;
    out.du[0] = -1.0 / cell;
    out.dv[0] = 0.0;
    out.n = 1;
    if (i + 1 >= count) return;
    out.bin[1] = i + 1;
    out.weight[1] = f;
    out.du[1] = 1.0 / cell;
    out.dv[1] = 0.0;
    out.n = 2;
  }

  LUCERNA_HD void deposit_square(const Vec3& direction, TentDeposit& out) const {
    if (dot(direction, axes.ez()) <= 0.0) return;
    deposit_grid(dot(direction, axes.ex()), dot(direction, axes.ey()), out);
  }

  LUCERNA_HD void deposit_plane(const Vec3& origin, const Vec3& direction, TentDeposit& out) const {
    const double fall = dot(direction, axes.ez());
    if (fall >= 0.0) return;
    const Vec3 from = origin - axes.origin_mm();
    const double t = -dot(from, axes.ez()) / fall;
    if (!(t > 0.0)) return;
    const Vec3 p = from + t * direction;
    deposit_grid(dot(p, axes.ex()) / half_x_mm, dot(p, axes.ey()) / half_y_mm, out);
  }

  /// Tents of the grid of count x count cells along both axes.
  LUCERNA_HD void deposit_grid(double window_u, double window_v, TentDeposit& out) const {
    double per_u = 0.0, per_v = 0.0;
    const double u = axis_u.tent_index(window_u, per_u) + 0.5, v = axis_v.tent_index(window_v, per_v) + 0.5;
    if (!(u >= 0.0 && v >= 0.0 && u < count + 1 && v < count + 1)) return;
    const int i = static_cast<int>(u) - 1, j = static_cast<int>(v) - 1;
    const double fu = u - (i + 1), fv = v - (j + 1);
    for (int b = 0; b < 2; ++b) {
      if (j + b < 0 || j + b >= count) continue;
      const double wv = b == 0 ? 1.0 - fv : fv, dv = b == 0 ? -per_v : per_v;
      for (int a = 0; a < 2; ++a) {
        if (i + a < 0 || i + a >= count) continue;
        const double wu = a == 0 ? 1.0 - fu : fu, du = a == 0 ? -per_u : per_u;
        const auto n = static_cast<std::size_t>(out.n++);
        out.bin[n] = (j + b) * count + i + a;
        out.weight[n] = wu * wv;
        out.du[n] = du * wv;
        out.dv[n] = wu * dv;
      }
    }
  }

  LUCERNA_HD void deposit_zone(const Vec3& direction, TentDeposit& out) const {
    const double x = dot(direction, axes.ex()), y = dot(direction, axes.ey());
    const double g = (std::atan2(std::hypot(x, y), dot(direction, axes.ez())) - gamma_min) / cell;
    if (!(g > 0.0 && g < count + 1)) return;
    const int ring = static_cast<int>(g) - 1;
    const double fg = g - (ring + 1);
    double c = std::atan2(y, x) / sector_width;
    if (c < 0.0) c += sectors;
    const int low = static_cast<int>(c) % sectors;
    const double fc = sectors == 1 ? 0.0 : c - std::floor(c);
    for (int b = 0; b < 2; ++b) {
      if (ring + b < 0 || ring + b >= count) continue;
      const double wg = b == 0 ? 1.0 - fg : fg, dg = (b == 0 ? -1.0 : 1.0) / cell;
      for (int a = 0; a < (sectors == 1 ? 1 : 2); ++a) {
        const double wc = a == 0 ? 1.0 - fc : fc;
        const double dc = sectors == 1 ? 0.0 : (a == 0 ? -1.0 : 1.0) / sector_width;
        const auto n = static_cast<std::size_t>(out.n++);
        out.bin[n] = (ring + b) * sectors + (low + a) % sectors;
        out.weight[n] = wg * wc;
        out.du[n] = dg * wc;
        out.dv[n] = wg * dc;
      }
    }
  }

  LUCERNA_HD TentGradient across_plane(const Vec3& origin, const Vec3& direction, const Vec3& axis,
                                       double half) const {
    // p = o + t d with t = -(o - c).n / (d.n): moving o or turning d slides p along the plane.
    const double fall = dot(direction, axes.ez());
    const double t = -dot(origin - axes.origin_mm(), axes.ez()) / fall;
    const Vec3 along = (axis - (dot(direction, axis) / fall) * axes.ez()) / half;
    return {t * along, along};
  }
};

}  // namespace lucerna
