// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/tent_bins.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// Directions of a circle that a function of direction is summed over, and circles of a ring.
constexpr int kAround = 360, kCircles = 64;

}  // namespace

TentBins::TentBins(TentKind kind, const Frame& axes, double extent, int count) {
  view_.kind = kind;
  view_.axes = axes;
  view_.extent = extent;
  view_.cell = (kind == TentKind::rings ? 1.0 : 2.0) * extent / count;
  view_.count = count;
  LUCERNA_CHECK(count >= 2 && extent > 0.0, "{} bins over {}", count, extent);
  view_.axis_u = view_.axis_v = tent_axis(-extent, extent, count, 0, -extent, extent);
}

void TentBins::set_axes(const TentAxis& u, const TentAxis& v) {
  LUCERNA_CHECK(u.count() == v.count() && u.count() == view_.count, "{} x {} cells", u.count(), v.count());
  view_.axis_u = u;
  view_.axis_v = v;
}

TentBins TentBins::graded(const Frame& axes, const TentAxis& u, const TentAxis& v) {
  TentBins bins(TentKind::square, axes, 1.0, u.count());
  bins.set_axes(u, v);
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

TentBins TentBins::graded_plane(const Frame& axes, double half_x_mm, double half_y_mm, const TentAxis& u,
                                const TentAxis& v) {
  LUCERNA_CHECK(half_x_mm > 0.0 && half_y_mm > 0.0, "bins over {} x {} mm", half_x_mm, half_y_mm);
  TentBins bins(TentKind::plane, axes, 1.0, u.count());
  bins.view_.half_x_mm = half_x_mm;
  bins.view_.half_y_mm = half_y_mm;
  bins.set_axes(u, v);
  bins.measure_ = bins.flux_on([](double, double) { return 1.0; });
  return bins;
}

TentBins TentBins::square(const Frame& axes, double half_width, int count) {
  LUCERNA_CHECK(half_width <= 1.0, "bins over direction cosines to {}", half_width);
  TentBins bins(TentKind::square, axes, half_width, count);
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

TentBins TentBins::rings(const Frame& axes, double gamma_max_rad, int count) {
  LUCERNA_CHECK(gamma_max_rad <= std::numbers::pi, "rings to {} rad", gamma_max_rad);
  TentBins bins(TentKind::rings, axes, gamma_max_rad, count);
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

TentBins TentBins::plane(const Frame& axes, double half_x_mm, double half_y_mm, int count, double widen) {
  LUCERNA_CHECK(half_x_mm > 0.0 && half_y_mm > 0.0, "bins over {} x {} mm", half_x_mm, half_y_mm);
  TentBins bins(TentKind::plane, axes, widen, count);
  bins.view_.half_x_mm = half_x_mm;
  bins.view_.half_y_mm = half_y_mm;
  bins.measure_ = bins.flux_on([](double, double) { return 1.0; });
  return bins;
}

TentBins TentBins::zone(const Frame& axes, double gamma_min_rad, int rings, int sectors) {
  const double width = std::numbers::pi - gamma_min_rad;
  LUCERNA_CHECK(gamma_min_rad >= 0.0 && width > 0.0 && sectors >= 1, "a zone from {} in {} sectors",
                gamma_min_rad, sectors);
  TentBins bins(TentKind::zone, axes, width, rings);
  bins.view_.cell = width / (rings + 1);  // centres one cell inside both ends
  bins.view_.gamma_min = gamma_min_rad;
  bins.view_.sectors = sectors;
  bins.view_.sector_width = 2.0 * std::numbers::pi / sectors;
  bins.measure_ = bins.flux_of([](const Direction&) { return 1.0; });
  return bins;
}

std::vector<double> TentBins::flux_of(const std::function<double(const Direction&)>& intensity) const {
  LUCERNA_CHECK(view_.kind != TentKind::plane, "intensity on a plane");
  if (is_rings()) return flux_of_rings(intensity);
  std::vector<double> flux(static_cast<std::size_t>(view_.size()), 0.0);
  Deposit d;
  const auto add = [&](const Direction& inner, double weight) {
    const Direction direction = view_.axes.direction(inner);
    deposit({}, direction, d);
    if (d.n == 0) return;
    const double value = weight * intensity(direction);
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
      flux[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * value;
    }
  };
  constexpr int kFineParts = 8;
  if (view_.kind == TentKind::zone) {
    const int around = std::max(kAround, kFineParts * view_.sectors);
    const double step = view_.cell / kFineParts, turn = 2.0 * std::numbers::pi / around;
    for (int g = 0; g < (view_.count + 1) * kFineParts; ++g) {
      const double gamma = view_.gamma_min + (g + 0.5) * step;
      if (gamma >= std::numbers::pi) break;
      const double s = std::sin(gamma);
      for (int c = 0; c < around; ++c) {
        const double a = (c + 0.5) * turn;
        add(Direction::from_unit({s * std::cos(a), s * std::sin(a), std::cos(gamma)}), step * turn * s);
      }
    }
    return flux;
  }
  over_grid(kFineParts, [&](double u, double v, double area) {
    const double w2 = 1.0 - u * u - v * v;
    if (w2 <= 0.0) return;
    const double w = std::sqrt(w2);
    add(Direction::from_unit({u, v, w}), area / w);
  });
  return flux;
}

std::vector<double> TentBins::flux_of_rings(const std::function<double(const Direction&)>& intensity) const {
  std::vector<std::array<double, 2>> around(kAround);
  const double turn = 2.0 * std::numbers::pi / kAround;
  for (std::size_t c = 0; c < around.size(); ++c) {
    const double a = (static_cast<double>(c) + 0.5) * turn;
    around[c] = {std::cos(a), std::sin(a)};
  }
  const double step = view_.cell / kCircles;
  // All directions of a circle are in the same rings.
  std::vector<double> circles(static_cast<std::size_t>(view_.count + 1) * kCircles, 0.0);
  const auto gamma = [&](std::size_t g) { return (static_cast<double>(g) + 0.5) * step; };
  parallel_blocks(circles.size(), 64, [&](std::size_t first, std::size_t last) {
    for (std::size_t g = first; g < last && gamma(g) < std::numbers::pi; ++g) {
      const double s = std::sin(gamma(g)), z = std::cos(gamma(g));
      double sum = 0.0;
      for (const auto& [x, y] : around)
        sum += intensity(view_.axes.direction(Direction::from_unit({s * x, s * y, z})));
      circles[g] = step * turn * s * sum;
    }
  });
  std::vector<double> flux(static_cast<std::size_t>(view_.size()), 0.0);
  Deposit d;
  for (std::size_t g = 0; g < circles.size() && gamma(g) < std::numbers::pi; ++g) {
    deposit({}, view_.axes.direction(Direction::from_unit({std::sin(gamma(g)), 0.0, std::cos(gamma(g))})), d);
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k)
      flux[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * circles[g];
  }
  return flux;
}

void TentBins::over_grid(int fine, const std::function<void(double, double, double)>& visit) const {
  const int n = (view_.count + 1) * fine;
  const double step = 1.0 / fine;
  for (int j = 0; j < n; ++j) {
    double dv = 0.0;
    const double v = view_.axis_v.coordinate((j + 0.5) * step - 0.5, dv);
    for (int i = 0; i < n; ++i) {
      double du = 0.0;
      const double u = view_.axis_u.coordinate((i + 0.5) * step - 0.5, du);
      visit(u, v, du * step * dv * step);
    }
  }
}

std::vector<double> TentBins::flux_on(const std::function<double(double, double)>& density_per_mm2) const {
  LUCERNA_CHECK(view_.kind == TentKind::plane, "a density over directions");
  std::vector<double> flux(static_cast<std::size_t>(view_.count * view_.count), 0.0);
  constexpr int kFineParts = 8;
  Deposit d;
  over_grid(kFineParts, [&](double u, double v, double area) {
    d.n = 0;
    view_.deposit_grid(u, v, d);
    const double value =
        area * view_.half_x_mm * view_.half_y_mm * density_per_mm2(u * view_.half_x_mm, v * view_.half_y_mm);
    for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k) {
      flux[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * value;
    }
  });
  return flux;
}

Direction bin_direction(const TentBins& bins, std::size_t i, const Vec3& from_mm) {
  const auto count = static_cast<std::size_t>(bins.count());
  const Frame& axes = bins.axes();
  if (bins.is_rings()) {
    const double gamma = bins.extent() * (static_cast<double>(i) + 0.5) / bins.count();
    return axes.direction(Direction::from_unit({std::sin(gamma), 0.0, std::cos(gamma)}));
  }
  double slope = 0.0;
  const double u = bins.view().axis_u.coordinate(static_cast<double>(i % count) + 0.5, slope);
  const double v = bins.view().axis_v.coordinate(static_cast<double>(i / count) + 0.5, slope);
  if (bins.is_plane()) {
    return Direction::from(axes.point({u * bins.half_x_mm(), v * bins.half_y_mm(), 0.0}) - from_mm);
  }
  return axes.direction(Direction::from({u, v, std::sqrt(std::max(0.0, 1.0 - u * u - v * v))}));
}

}  // namespace lucerna
