// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/window.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// The smallest extent that holds `share` of `total` among (extent, flux) pairs.
double quantile(std::vector<std::pair<double, double>> extents, double total, double share) {
  std::sort(extents.begin(), extents.end());
  double sum = 0.0;
  for (const auto& [extent, flux] : extents) {
    sum += flux;
    if (sum >= share * total) return extent;
  }
  return extents.back().first;
}

double total_of(std::span<const DirectedFlux> light) {
  double total = 0.0;
  for (const DirectedFlux& l : light) total += l.flux;
  if (!(total > 0.0)) throw InputError("design: the target has no light");
  return total;
}

}  // namespace

TentBins square_window(std::span<const DirectedFlux> light, const Direction& fallback,
                       const WindowOptions& options) {
  const double total = total_of(light);
  Vec3 mean;
  for (const DirectedFlux& l : light) mean += (l.flux / total) * l.direction.vec();
  const Direction axis = length(mean) < 0.2 ? fallback : Direction::from(mean);
  const Vec3 x = std::abs(axis.x()) < 0.9 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Direction ex = Direction::from(x - dot(x, axis) * axis.vec());
  const Frame axes(ex, cross(axis, ex), axis, {});
  std::vector<std::pair<double, double>> extents;
  double front = 0.0;
  for (const DirectedFlux& l : light) {
    if (dot(l.direction, axis) <= 0.0) continue;
    front += l.flux;
    extents.emplace_back(
        std::max(std::abs(dot(l.direction, axes.ex())), std::abs(dot(l.direction, axes.ey()))), l.flux);
  }
  if (front < 0.5 * total) {
    throw InputError(fmt::format(
        "design: only {:.0f} % of the target's light is on one side of its mean direction; expected half",
        100.0 * front / total));
  }
  const double half = std::clamp(quantile(std::move(extents), front, options.share), 1e-4, 1.0);
  return TentBins::square(axes, half, options.count);
}

TentBins ring_window(std::span<const DirectedFlux> light, const Direction& axis,
                     const WindowOptions& options) {
  const double total = total_of(light);
  std::vector<std::pair<double, double>> extents;
  for (const DirectedFlux& l : light) extents.emplace_back(angle_between(l.direction, axis), l.flux);
  const double gamma = std::clamp(quantile(std::move(extents), total, options.share), 1e-4, std::numbers::pi);
  return TentBins::rings(Frame::from_axis(axis, 0.0, {}), gamma, options.count);
}

std::vector<DirectedFlux> directed_flux(const IntensityDistribution& distribution) {
  constexpr double kStep_deg = 0.5;
  std::vector<DirectedFlux> light;
  const bool rotational = distribution.c_deg.size() == 1;
  const double c_step = rotational ? 2.0 : kStep_deg;
  for (double gamma = 0.5 * kStep_deg; gamma < 180.0; gamma += kStep_deg) {
    const double ring = radians(kStep_deg) * radians(c_step) * std::sin(radians(gamma));
    for (double c = 0.5 * c_step; c < 360.0; c += c_step) {
      const double cd = intensity_at(distribution, c, gamma);
      if (cd > 0.0) light.push_back({direction_from_type_c({radians(c), radians(gamma)}), cd * ring});
    }
  }
  return light;
}

TentBins rebinned(const TentBins& bins, double factor, int count) {
  if (bins.is_rings()) {
    return TentBins::rings(bins.axes(), std::min(std::numbers::pi, factor * bins.extent()), count);
  }
  if (bins.is_plane()) {
    return TentBins::plane(bins.axes(), bins.half_x_mm(), bins.half_y_mm(), count, factor * bins.extent());
  }
  return TentBins::square(bins.axes(), std::min(1.0, factor * bins.extent()), count);
}

}  // namespace lucerna
