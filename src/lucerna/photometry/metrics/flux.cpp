// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

std::vector<double> plane_weights(std::span<const double> c_deg) {
  const std::size_t n = c_deg.size();
  LUCERNA_CHECK(n > 0, "no planes");
  std::vector<double> weights(n);
  for (std::size_t i = 0; i < n; ++i) {
    const double before = i == 0 ? c_deg[n - 1] - 360.0 : c_deg[i - 1];
    const double after = i + 1 == n ? c_deg[0] + 360.0 : c_deg[i + 1];
    weights[i] = (after - before) / 720.0;
  }
  return weights;
}

std::vector<double> ring_weights_sr(std::span<const double> gamma_deg) {
  const std::size_t n = gamma_deg.size();
  LUCERNA_CHECK(n > 1, "{} rings", n);
  std::vector<double> u(n), weights(n);
  for (std::size_t g = 0; g < n; ++g) u[g] = std::cos(radians(gamma_deg[g]));
  for (std::size_t g = 0; g < n; ++g) {
    weights[g] = std::numbers::pi * (u[g == 0 ? 0 : g - 1] - u[g + 1 == n ? g : g + 1]);
  }
  return weights;
}

std::vector<double> ring_means(const IntensityDistribution& d) {
  const std::vector<double> weights = plane_weights(d.c_deg);
  std::vector<double> means(d.gamma_deg.size(), 0.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < means.size(); ++g) means[g] += weights[c] * d.at(c, g);
  }
  return means;
}

double total_flux(const IntensityDistribution& d) {
  const std::vector<double> weights = ring_weights_sr(d.gamma_deg), means = ring_means(d);
  double flux = 0.0;
  for (std::size_t g = 0; g < means.size(); ++g) flux += weights[g] * means[g];
  return flux;
}

double zonal_flux(const IntensityDistribution& d, double from_deg, double to_deg) {
  const std::vector<double> means = ring_means(d);
  double flux = 0.0;
  for (std::size_t g = 0; g + 1 < means.size(); ++g) {
    const double g0 = d.gamma_deg[g], g1 = d.gamma_deg[g + 1];
    const double a = std::max(g0, from_deg), b = std::min(g1, to_deg);
    if (a >= b) continue;
    const auto mean_at = [&](double x) {
      return means[g] + (means[g + 1] - means[g]) * (x - g0) / (g1 - g0);
    };
    flux += std::numbers::pi * (std::cos(radians(a)) - std::cos(radians(b))) * (mean_at(a) + mean_at(b));
  }
  return flux;
}

}  // namespace lucerna
