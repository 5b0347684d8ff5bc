// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/tent_bins.h"

#include <cmath>
#include <numbers>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"

namespace lucerna {

TentBins::TentBins(bool rings, const Frame& axes, double extent, int count)
    : rings_(rings),
      axes_(axes),
      extent_(extent),
      cell_((rings ? 1.0 : 2.0) * extent / count),
      count_(count) {
  LUCERNA_CHECK(count >= 2 && extent > 0.0 && extent <= (rings ? std::numbers::pi : 1.0), "{} bins over {}",
                count, extent);
  solid_angle_ = flux_of([](const Direction&) { return 1.0; });
}

TentBins TentBins::square(const Frame& axes, double half_width, int count) {
  TentBins bins(false, axes, half_width, count);
  return bins;
}

TentBins TentBins::rings(const Frame& axes, double gamma_max_rad, int count) {
  return {true, axes, gamma_max_rad, count};
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
  const double u = (dot(direction, axes_.ex()) + extent_) / cell_ + 0.5;
  const double v = (dot(direction, axes_.ey()) + extent_) / cell_ + 0.5;
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

std::vector<double> TentBins::flux_of(const std::function<double(const Direction&)>& intensity) const {
  const auto bins = static_cast<std::size_t>(rings_ ? count_ : count_ * count_);
  std::vector<double> flux(bins, 0.0);
  Deposit d;
  const auto add = [&](const Direction& inner, double weight) {
    const Direction direction = axes_.direction(inner);
    deposit(direction, d);
    if (d.n == 0) return;
    const double value = weight * intensity(direction);
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
      flux[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * value;
    }
  };
  if (rings_) {
    constexpr int kFine = 64, kAround = 360;
    const double step = cell_ / kFine, turn = 2.0 * std::numbers::pi / kAround;
    for (int g = 0; g < (count_ + 1) * kFine; ++g) {
      const double gamma = (g + 0.5) * step;
      if (gamma >= std::numbers::pi) break;
      const double s = std::sin(gamma);
      for (int c = 0; c < kAround; ++c) {
        const double a = (c + 0.5) * turn;
        add(Direction::from_unit({s * std::cos(a), s * std::sin(a), std::cos(gamma)}), step * turn * s);
      }
    }
    return flux;
  }
  constexpr int kFine = 8;
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

}  // namespace lucerna
