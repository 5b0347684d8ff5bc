// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_zones.h"

#include <fmt/format.h>

#include <cmath>

#include "lucerna/photometric_metrics.h"

namespace lucerna {

Zone zone(const FarFieldTable& table, double from_deg, double to_deg) {
  const IntensityDistribution& d = table.distribution;
  Zone z{from_deg, to_deg, {zonal_flux(d, from_deg, to_deg), std::nan("")}};
  if (table.standard_error.empty()) return z;
  // zonal_flux is linear in the ring means: the flux of one ring at 1 cd is that ring's weight.
  const std::vector<double> planes = plane_weights(d.c_deg);
  IntensityDistribution one = zero_distribution({0.0}, d.gamma_deg, d.unit);
  double variance = 0.0;
  for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
    if (g > 0 && d.gamma_deg[g - 1] > to_deg) break;
    if (g + 1 < d.gamma_deg.size() && d.gamma_deg[g + 1] < from_deg) continue;
    one.cd[g] = 1.0;
    const double ring = zonal_flux(one, from_deg, to_deg);
    one.cd[g] = 0.0;
    for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
      const double part = ring * planes[c] * table.standard_error[c * d.gamma_deg.size() + g];
      variance += part * part;
    }
  }
  z.flux.standard_error = std::sqrt(variance);
  return z;
}

std::vector<Zone> ten_degree_zones(const FarFieldTable& table) {
  std::vector<Zone> zones;
  for (int from = 0; from < 180; from += 10) zones.push_back(zone(table, from, from + 10));
  return zones;
}

std::vector<Zone> summed_zones(const FarFieldTable& table) {
  std::vector<Zone> zones;
  for (const auto& [from, to] : {std::pair{0, 30}, {0, 40}, {0, 60}, {60, 90}, {0, 90}, {90, 180}}) {
    zones.push_back(zone(table, from, to));
  }
  return zones;
}

std::string cie_flux_code(const FarFieldTable& table, double light_output_ratio) {
  const auto within = [&](double gamma) { return zonal_flux(table.distribution, 0.0, gamma); };
  const double down = within(90.0), all = within(180.0);
  if (!(down > 0.0)) return "";
  return fmt::format("{:.0f} {:.0f} {:.0f} {:.0f} {:.0f}", 100.0 * within(41.4) / down,
                     100.0 * within(60.0) / down, 100.0 * within(75.5) / down, 100.0 * down / all,
                     100.0 * light_output_ratio);
}

}  // namespace lucerna
