// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/prescribed_angle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "lucerna/geometry.h"

namespace lucerna {
namespace {

/// Even intensity from 10 to 30 degrees from +z, in rings.
Eigen::VectorXd even_flux(const TentBins& bins) {
  Eigen::VectorXd out(bins.count());
  const double step = bins.extent() / bins.count();
  const auto within = [](double gamma) {
    return std::cos(radians(10.0)) - std::cos(std::clamp(gamma, radians(10.0), radians(30.0)));
  };
  for (int i = 0; i < bins.count(); ++i) out[i] = within((i + 1) * step) - within(i * step);
  return out;
}

TEST(PrescribedAngle, IsThatWithinWhichTheShareOfTheFluxIs) {
  const PrescribedAngle angle(even_flux);
  const double step = radians(0.5);
  EXPECT_NEAR(angle.of(0.0), radians(10.0), 1e-9);
  EXPECT_NEAR(angle.of(1.0), radians(30.0), 1e-9);
  const double from = std::cos(radians(10.0)), to = std::cos(radians(30.0));
  for (const double share : {0.01, 0.1, 0.5, 0.9})
    EXPECT_NEAR(angle.of(share), std::acos(from + share * (to - from)), 0.1 * step);
}

TEST(PrescribedAngle, GrowsWithTheShare) {
  const PrescribedAngle angle(even_flux);
  for (int i = 0; i < 100; ++i) EXPECT_LE(angle.of(0.01 * i), angle.of(0.01 * (i + 1)));
}

TEST(MeridianLight, HoldsAllFluxInItsRings) {
  PointSource source{};
  const auto add = [&](double theta_deg, double flux) {
    const double t = radians(theta_deg);
    source.light.push_back({Direction::from_unit({std::sin(t), 0.0, std::cos(t)}), flux});
  };
  add(0.0, 0.25);
  add(95.0, 0.5);
  add(180.0, 0.25);
  const std::vector<double> rings = meridian_light(source, 18);
  ASSERT_EQ(rings.size(), 18u);
  EXPECT_EQ(rings[0], 0.25);
  EXPECT_EQ(rings[9], 0.5);
  EXPECT_EQ(rings[17], 0.25);
  EXPECT_EQ(std::accumulate(rings.begin(), rings.end(), 0.0), 1.0);
}

}  // namespace
}  // namespace lucerna
