// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/formats/type_ab.h"

#include <algorithm>
#include <cmath>

#include "lucerna/photometric_metrics.h"

namespace lucerna {

namespace {

/// Lower index and fraction of `x` in ascending `angles`, or false outside.
bool locate(const std::vector<double>& angles, double x, std::size_t& low, double& fraction) {
  if (!(x >= angles.front() - 1e-9 && x <= angles.back() + 1e-9)) return false;
  const auto above = std::upper_bound(angles.begin(), angles.end(), x);
  const std::size_t high =
      std::clamp<std::size_t>(static_cast<std::size_t>(above - angles.begin()), 1, angles.size() - 1);
  low = high - 1;
  fraction = std::clamp((x - angles[low]) / (angles[high] - angles[low]), 0.0, 1.0);
  return true;
}

}  // namespace

double type_ab_flux(const TypeAbGrid& grid) {
  const bool b = grid.type == 'B';
  const auto measure = [](bool sine, double angle_deg) {
    return sine ? std::sin(radians(angle_deg)) : radians(angle_deg);
  };
  double flux = 0.0;
  const std::size_t nv = grid.v_deg.size();
  for (std::size_t h = 0; h + 1 < grid.h_deg.size(); ++h) {
    const double dh = measure(b, grid.h_deg[h + 1]) - measure(b, grid.h_deg[h]);
    for (std::size_t v = 0; v + 1 < nv; ++v) {
      const double dv = measure(!b, grid.v_deg[v + 1]) - measure(!b, grid.v_deg[v]);
      const double* a = &grid.cd[h * nv + v];
      flux += 0.25 * (a[0] + a[1] + a[nv] + a[nv + 1]) * dh * dv;
    }
  }
  return grid.mirrored_h ? 2.0 * flux : flux;
}

double type_ab_intensity(const TypeAbGrid& grid, double h_deg, double v_deg) {
  std::size_t h = 0, v = 0;
  double th = 0.0, tv = 0.0;
  if (!locate(grid.h_deg, grid.mirrored_h ? std::abs(h_deg) : h_deg, h, th) ||
      !locate(grid.v_deg, v_deg, v, tv))
    return 0.0;
  const std::size_t nv = grid.v_deg.size();
  const double* a = &grid.cd[h * nv + v];
  return (1.0 - th) * ((1.0 - tv) * a[0] + tv * a[1]) + th * ((1.0 - tv) * a[nv] + tv * a[nv + 1]);
}

IntensityDistribution type_c_from_ab(const TypeAbGrid& grid, double& scale_used) {
  std::vector<double> planes, gammas;
  for (int c = 0; c < 144; ++c) planes.push_back(2.5 * c);
  for (int g = 0; g <= 90; ++g) gammas.push_back(g);
  IntensityDistribution d = zero_distribution(std::move(planes), std::move(gammas));
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      const double gamma = radians(d.gamma_deg[g]), plane = radians(d.c_deg[c]);
      // forward, up, right of the luminaire as seen from behind it
      const double forward = std::cos(gamma), up = std::sin(gamma) * std::cos(plane);
      const double right = -std::sin(gamma) * std::sin(plane);
      const bool b = grid.type == 'B';
      const double h = b ? std::asin(std::clamp(right, -1.0, 1.0)) : std::atan2(right, forward);
      const double v = b ? std::atan2(up, forward) : std::asin(std::clamp(up, -1.0, 1.0));
      d.at(c, g) = type_ab_intensity(grid, degrees(h), degrees(v));
    }
  }
  const double flux = total_flux(d);
  scale_used = flux > 0.0 ? type_ab_flux(grid) / flux : 1.0;
  scale(d, scale_used);
  return d;
}

}  // namespace lucerna
