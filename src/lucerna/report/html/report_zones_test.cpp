// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/html/report_zones.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/photometric_metrics.h"

namespace lucerna {
namespace {

/// I = 100 cos gamma downward: 50 % of the flux within 45 degrees, (1 - cos 2g) / 2 within g.
FarFieldTable lambertian() {
  FarFieldTable table{"far", uniform_distribution(30.0, 0.5), {}};
  auto& d = table.distribution;
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g)
      d.at(c, g) = std::max(0.0, 100.0 * std::cos(radians(d.gamma_deg[g])));
  }
  return table;
}

TEST(ReportZones, AddUpToTheWholeAndMatchTheClosedForm) {
  const FarFieldTable table = lambertian();
  double sum = 0.0;
  for (const Zone& z : ten_degree_zones(table)) {
    const auto within = [](double deg) {
      return 50.0 * std::numbers::pi * (1.0 - std::cos(2.0 * radians(deg)));
    };
    const double exact = within(std::min(90.0, z.to_deg)) - within(std::min(90.0, z.from_deg));
    EXPECT_NEAR(z.flux.mean, exact, 0.01) << z.from_deg;
    EXPECT_TRUE(std::isnan(z.flux.standard_error));
    sum += z.flux.mean;
  }
  EXPECT_NEAR(sum, total_flux(table.distribution), 1e-9);
}

TEST(ReportZones, ErrorIsThatOfTheSumOfCells) {
  FarFieldTable table = lambertian();
  table.standard_error.assign(table.distribution.cd.size(), 2.0);
  const auto& d = table.distribution;
  const auto rings = ring_weights_sr(d.gamma_deg);
  double variance = 0.0;
  for (const double w : rings) variance += 12.0 * std::pow(w / 12.0 * 2.0, 2);
  EXPECT_NEAR(zone(table, 0.0, 180.0).flux.standard_error, std::sqrt(variance), 1e-9);
  // Two halves that meet on a grid angle share one ring: their variances add up to nearly the whole.
  const double a = zone(table, 0.0, 90.0).flux.standard_error,
               b = zone(table, 90.0, 180.0).flux.standard_error;
  EXPECT_NEAR(std::hypot(a, b), std::sqrt(variance), 0.01 * std::sqrt(variance));
}

TEST(ReportZones, FluxCodeOfALambertian) {
  // sin^2 of 41.4, 60, 75.5 degrees: 0.437, 0.75, 0.937.
  EXPECT_EQ(cie_flux_code(lambertian(), 0.83), "44 75 94 100 83");
  FarFieldTable up = lambertian();
  for (double& cd : up.distribution.cd) cd = 0.0;
  EXPECT_EQ(cie_flux_code(up, 0.83), "");
}

}  // namespace
}  // namespace lucerna
