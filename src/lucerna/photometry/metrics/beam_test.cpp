// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {
namespace {

IntensityDistribution filled(const std::function<double(double c, double g)>& cd) {
  IntensityDistribution d = uniform_distribution(10.0, 1.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) d.at(c, g) = cd(d.c_deg[c], d.gamma_deg[g]);
  }
  return d;
}

double tent(double x, double half_width) { return std::max(0.0, 1.0 - std::abs(x) / half_width); }

TEST(Beam, LinearFlanksGiveExactAngles) {
  const auto d = filled([](double, double g) { return 800.0 * tent(g, 20.0); });
  EXPECT_NEAR(*beam_angle_deg(d, 0.0, 0.5, BeamReference::maximum), 20.0, 1e-9);
  EXPECT_NEAR(*beam_angle_deg(d, 0.0, 0.1, BeamReference::centre), 36.0, 1e-9);
  EXPECT_DOUBLE_EQ(peak_intensity(d).cd, 800.0);
}

// A batwing is where the definitions differ: 50 % of the wings against 50 % of the dip.
TEST(Beam, BatwingTellsTheDefinitionsApart) {
  const auto d =
      filled([](double, double g) { return 100.0 * tent(g, 50.0) + 300.0 * tent(g - 40.0, 20.0); });
  const double of_maximum = *beam_angle_deg(d, 0.0, 0.5, BeamReference::maximum);
  const double of_centre = *beam_angle_deg(d, 0.0, 0.5, BeamReference::centre);
  EXPECT_NEAR(of_maximum, 2.0 * (40.0 + 20.0 * (1.0 - 160.0 / 300.0)), 1.5);
  EXPECT_GT(of_centre, of_maximum + 10.0);
}

TEST(Beam, UplightIsMeasuredAboutTheZenith) {
  const auto d = filled([](double, double g) { return 500.0 * tent(180.0 - g, 30.0); });
  EXPECT_EQ(axis_gamma_deg(d), 180.0);
  EXPECT_NEAR(*beam_angle_deg(d, 0.0, 0.5, BeamReference::centre), 30.0, 1e-9);
  EXPECT_EQ(beam_metrics(d).centre_cd, 500.0);
}

TEST(Beam, TiltedBeamKeepsItsWidth) {
  const auto d = filled([](double c, double g) { return c == 0.0 ? 100.0 * tent(g - 45.0, 10.0) : 0.0; });
  EXPECT_NEAR(*beam_angle_deg(d, 0.0, 0.5, BeamReference::maximum), 10.0, 1e-9);
  EXPECT_NEAR(*beam_angle_deg(d, 180.0, 0.5, BeamReference::maximum), 10.0, 1e-9);
  EXPECT_FALSE(beam_angle_deg(d, 90.0, 0.5, BeamReference::maximum));
  EXPECT_FALSE(beam_angle_deg(d, 0.0, 0.5, BeamReference::centre));
}

TEST(Beam, GridThatEndsAtTheHorizonCutsTheBeam) {
  IntensityDistribution d = zero_distribution({0.0}, {0.0, 45.0, 90.0});
  d.cd = {100.0, 100.0, 100.0};
  EXPECT_NEAR(*beam_angle_deg(d, 0.0, 0.5, BeamReference::maximum), 180.0, 1e-6);
  EXPECT_EQ(*beam_angle_deg(filled([](double, double) { return 1.0; }), 0.0, 0.5, BeamReference::maximum),
            360.0);
}

TEST(Beam, FiguresOfNothing) {
  const BeamMetrics f = beam_metrics(uniform_distribution(90.0, 10.0));
  EXPECT_EQ(f.flux, 0.0);
  EXPECT_FALSE(f.planes.front().beam_of_maximum);
}

}  // namespace
}  // namespace lucerna
