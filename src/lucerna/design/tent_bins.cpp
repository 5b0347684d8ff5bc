// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/tent_bins.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"

namespace lucerna {

TentBins::TentBins(Kind kind, const Frame& axes, double extent, int count)
    : kind_(kind),
      axes_(axes),
      extent_(extent),
      cell_((kind == Kind::rings ? 1.0 : 2.0) * extent / count),
      count_(count) {
  LUCERNA_CHECK(count >= 2 && extent > 0.0, "{} bins over {}", count, extent);
}

TentBins TentBins::square(const Frame& axes, double half_width, int count) {
  LUCERNA_CHECK(half_width <= 1.0, "bins over direction cosines to {}", half_width);
  TentBins bins(Kind::square, axes, half_width, count);
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

TentBins TentBins::rings(const Frame& axes, double gamma_max_rad, int count) {
  LUCERNA_CHECK(gamma_max_rad <= std::numbers::pi, "rings to {} rad", gamma_max_rad);
  TentBins bins(Kind::rings, axes, gamma_max_rad, count);
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

TentBins TentBins::plane(const Frame& axes, double half_x_mm, double half_y_mm, int count, double widen) {
  LUCERNA_CHECK(half_x_mm > 0.0 && half_y_mm > 0.0, "bins over {} x {} mm", half_x_mm, half_y_mm);
  TentBins bins(Kind::plane, axes, widen, count);
  bins.half_x_mm_ = half_x_mm;
  bins.half_y_mm_ = half_y_mm;
  bins.measure_ = bins.flux_on([](double, double) { return 1.0; });
  return bins;
}

TentBins TentBins::zone(const Frame& axes, double gamma_min_rad, int rings, int sectors) {
  const double width = std::numbers::pi - gamma_min_rad;
  LUCERNA_CHECK(gamma_min_rad >= 0.0 && width > 0.0 && sectors >= 1, "a zone from {} in {} sectors",
                gamma_min_rad, sectors);
  TentBins bins(Kind::zone, axes, width, rings);
  bins.cell_ = width / (rings + 1);  // centres one cell inside both ends
  bins.gamma_min_ = gamma_min_rad;
  bins.sectors_ = sectors;
  bins.sector_ = 2.0 * std::numbers::pi / sectors;
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

void TentBins::deposit_ring(const Vec3& direction, Deposit& out) const {
  const double c = dot(direction, axes_.ez());
  const double gamma = std::atan2(length(cross(direction, axes_.ez())), c);
  const double s = gamma / cell_ - 0.5;
  if (s < 0.0) {  // the innermost bin is flat at the axis
    out.n = 1;
    out.bin[0] = 0;
    out.weight[0] = 1.0;
    out.du[0] = out.dv[0] = 0.0;
    return;
  }
  if (s >= count_) return;
  const int i = static_cast<int>(s);
  const double f = s - i;
  out.bin[0] = i;
  out.weight[0] = 1.0 - f;
  out.du[0] = -1.0 / cell_;
  out.dv[0] = 0.0;
  out.n = 1;
  if (i + 1 >= count_) return;
  out.bin[1] = i + 1;
  out.weight[1] = f;
  out.du[1] = 1.0 / cell_;
  out.dv[1] = 0.0;
  out.n = 2;
}

void TentBins::deposit_square(const Vec3& direction, Deposit& out) const {
  if (dot(direction, axes_.ez()) <= 0.0) return;
  deposit_grid(dot(direction, axes_.ex()), dot(direction, axes_.ey()), out);
}

void TentBins::deposit_plane(const Vec3& origin, const Vec3& direction, Deposit& out) const {
  const double fall = dot(direction, axes_.ez());
  if (fall >= 0.0) return;
  const Vec3 from = origin - axes_.origin_mm();
  const double t = -dot(from, axes_.ez()) / fall;
  if (!(t > 0.0)) return;
  const Vec3 p = from + t * direction;
  deposit_grid(dot(p, axes_.ex()) / half_x_mm_, dot(p, axes_.ey()) / half_y_mm_, out);
}

void TentBins::deposit_grid(double window_u, double window_v, Deposit& out) const {
  const double u = (window_u + extent_) / cell_ + 0.5, v = (window_v + extent_) / cell_ + 0.5;
  if (!(u >= 0.0 && v >= 0.0 && u < count_ + 1 && v < count_ + 1)) return;
  const int i = static_cast<int>(u) - 1, j = static_cast<int>(v) - 1;
  const double fu = u - (i + 1), fv = v - (j + 1), per = 1.0 / cell_;
  for (int b = 0; b < 2; ++b) {
    if (j + b < 0 || j + b >= count_) continue;
    const double wv = b == 0 ? 1.0 - fv : fv, dv = b == 0 ? -per : per;
    for (int a = 0; a < 2; ++a) {
      if (i + a < 0 || i + a >= count_) continue;
      const double wu = a == 0 ? 1.0 - fu : fu, du = a == 0 ? -per : per;
      const auto n = static_cast<std::size_t>(out.n++);
      out.bin[n] = (j + b) * count_ + i + a;
      out.weight[n] = wu * wv;
      out.du[n] = du * wv;
      out.dv[n] = wu * dv;
    }
  }
}

void TentBins::deposit_zone(const Vec3& direction, Deposit& out) const {
  const double x = dot(direction, axes_.ex()), y = dot(direction, axes_.ey());
  const double g = (std::atan2(std::hypot(x, y), dot(direction, axes_.ez())) - gamma_min_) / cell_;
  if (!(g > 0.0 && g < count_ + 1)) return;
  const int ring = static_cast<int>(g) - 1;
  const double fg = g - (ring + 1);
  double c = std::atan2(y, x) / sector_;
  if (c < 0.0) c += sectors_;
  const int low = static_cast<int>(c) % sectors_;
  const double fc = sectors_ == 1 ? 0.0 : c - std::floor(c);
  for (int b = 0; b < 2; ++b) {
    if (ring + b < 0 || ring + b >= count_) continue;
    const double wg = b == 0 ? 1.0 - fg : fg, dg = (b == 0 ? -1.0 : 1.0) / cell_;
    for (int a = 0; a < (sectors_ == 1 ? 1 : 2); ++a) {
      const double wc = a == 0 ? 1.0 - fc : fc;
      const double dc = sectors_ == 1 ? 0.0 : (a == 0 ? -1.0 : 1.0) / sector_;
      const auto n = static_cast<std::size_t>(out.n++);
      out.bin[n] = (ring + b) * sectors_ + (low + a) % sectors_;
      out.weight[n] = wg * wc;
      out.du[n] = dg * wc;
      out.dv[n] = wg * dc;
    }
  }
}

TentBins::Gradient TentBins::across_plane(const Vec3& origin, const Vec3& direction, const Vec3& axis,
                                          double half) const {
  // p = o + t d with t = -(o - c).n / (d.n): moving o or turning d slides p along the plane.
  const double fall = dot(direction, axes_.ez());
  const double t = -dot(origin - axes_.origin_mm(), axes_.ez()) / fall;
  const Vec3 along = (axis - (dot(direction, axis) / fall) * axes_.ez()) / half;
  return {t * along, along};
}

TentBins::Gradient TentBins::gradient_u(const Vec3& origin, const Vec3& direction) const {
  if (kind_ == Kind::square) return {axes_.ex(), {}};
  if (kind_ == Kind::plane) return across_plane(origin, direction, axes_.ex(), half_x_mm_);
  const double s = length(cross(direction, axes_.ez()));
  return {s > 1e-12 ? (-1.0 / s) * axes_.ez() : Vec3{}, {}};
}

TentBins::Gradient TentBins::gradient_v(const Vec3& origin, const Vec3& direction) const {
  if (kind_ == Kind::square) return {axes_.ey(), {}};
  if (kind_ == Kind::plane) return across_plane(origin, direction, axes_.ey(), half_y_mm_);
  const double x = dot(direction, axes_.ex()), y = dot(direction, axes_.ey());
  const double square = x * x + y * y;
  if (square < 1e-24) return {};
  return {(x / square) * axes_.ey() - (y / square) * axes_.ex(), {}};
}

std::vector<double> TentBins::flux_of(const std::function<double(const Direction&)>& intensity) const {
  LUCERNA_CHECK(kind_ != Kind::plane, "intensity on a plane");
  std::vector<double> flux(static_cast<std::size_t>(is_rings()            ? count_
                                                    : kind_ == Kind::zone ? count_ * sectors_
                                                                          : count_ * count_),
                           0.0);
  Deposit d;
  const auto add = [&](const Direction& inner, double weight) {
    const Direction direction = axes_.direction(inner);
    deposit({}, direction, d);
    if (d.n == 0) return;
    const double value = weight * intensity(direction);
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
      flux[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * value;
    }
  };
  constexpr int kFine = 8;
  if (kind_ != Kind::square) {
    const int fine = is_rings() ? 64 : kFine, around = is_rings() ? 360 : std::max(360, kFine * sectors_);
    const double step = cell_ / fine, turn = 2.0 * std::numbers::pi / around;
    for (int g = 0; g < (count_ + 1) * fine; ++g) {
      const double gamma = gamma_min_ + (g + 0.5) * step;
      if (gamma >= std::numbers::pi) break;
      const double s = std::sin(gamma);
      for (int c = 0; c < around; ++c) {
        const double a = (c + 0.5) * turn;
        add(Direction::from_unit({s * std::cos(a), s * std::sin(a), std::cos(gamma)}), step * turn * s);
      }
    }
    return flux;
  }
  const int n = (count_ + 1) * kFine;
  const double step = cell_ / kFine, start = -extent_ - 0.5 * cell_;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double u = start + (i + 0.5) * step, v = start + (j + 0.5) * step;
      const double w2 = 1.0 - u * u - v * v;
      if (w2 <= 0.0) continue;
      const double w = std::sqrt(w2);
      add(Direction::from_unit({u, v, w}), step * step / w);
    }
  }
  return flux;
}

std::vector<double> TentBins::flux_on(const std::function<double(double, double)>& density_per_mm2) const {
  LUCERNA_CHECK(kind_ == Kind::plane, "a density over directions");
  std::vector<double> flux(static_cast<std::size_t>(count_ * count_), 0.0);
  constexpr int kFine = 8;
  const int n = (count_ + 1) * kFine;
  const double step = cell_ / kFine, start = -extent_ - 0.5 * cell_;
  const double area_mm2 = step * half_x_mm_ * step * half_y_mm_;
  Deposit d;
  for (int j = 0; j < n; ++j) {
    for (int i = 0; i < n; ++i) {
      const double u = start + (i + 0.5) * step, v = start + (j + 0.5) * step;
      d.n = 0;
      deposit_grid(u, v, d);
      const double value = area_mm2 * density_per_mm2(u * half_x_mm_, v * half_y_mm_);
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
        flux[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * value;
      }
    }
  }
  return flux;
}

}  // namespace lucerna
