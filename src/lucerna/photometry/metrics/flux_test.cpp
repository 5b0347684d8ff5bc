// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Flux, WeightsCoverCircleAndSphere) {
  double sum = 0.0;
  for (const double w : plane_weights(std::vector<double>{0.0, 10.0, 45.0, 300.0})) sum += w;
  EXPECT_NEAR(sum, 1.0, 1e-15);
  sum = 0.0;
  for (const double w : ring_weights_sr(std::vector<double>{0.0, 7.0, 50.0, 120.0, 180.0})) sum += w;
  EXPECT_NEAR(sum, 4.0 * kPi, 1e-13);
}

TEST(Flux, IsotropicSourceIsExact) {
  IntensityDistribution d = uniform_distribution(30.0, 7.5);
  for (double& value : d.cd) value = 100.0;
  EXPECT_NEAR(total_flux(d), 400.0 * kPi, 1e-10);
  EXPECT_NEAR(zonal_flux(d, 0.0, 90.0), 200.0 * kPi, 1e-10);
  EXPECT_NEAR(zonal_flux(d, 0.0, 41.4), 200.0 * kPi * (1.0 - std::cos(radians(41.4))), 1e-10);
}

// The rule worked by hand on three rings and two planes, one of which is twice as wide as the other.
TEST(Flux, FollowsTheTradesRule) {
  IntensityDistribution d = zero_distribution({0.0, 90.0, 180.0}, {0.0, 60.0, 90.0});
  d.cd = {10.0, 6.0, 0.0, 10.0, 2.0, 0.0, 10.0, 4.0, 0.0};
  // Planes 0, 90, 180 weigh (90 + 180) / 720, 180 / 720, 270 / 720.
  const double ring = 0.375 * 6.0 + 0.25 * 2.0 + 0.375 * 4.0;
  const double by_hand = 0.5 * (10.0 + ring) * 2.0 * kPi * 0.5 + 0.5 * (ring + 0.0) * 2.0 * kPi * 0.5;
  EXPECT_NEAR(total_flux(d), by_hand, 1e-12);
}

TEST(Flux, ZonesAddUp) {
  IntensityDistribution d = uniform_distribution(15.0, 5.0);
  for (std::size_t i = 0; i < d.cd.size(); ++i) d.cd[i] = static_cast<double>((i * 7919) % 101);
  double sum = 0.0;
  for (int zone = 0; zone < 18; ++zone) sum += zonal_flux(d, 10.0 * zone, 10.0 * (zone + 1));
  EXPECT_NEAR(sum, total_flux(d), 1e-9);
}

TEST(IntensityGrid, NamesWhatIsWrong) {
  EXPECT_THROW(uniform_distribution(7.0, 1.0), InputError);
  EXPECT_THROW(zero_distribution({10.0, 20.0}, {0.0, 90.0}), InputError);
  EXPECT_THROW(zero_distribution({0.0, 360.0}, {0.0, 90.0}), InputError);
  EXPECT_THROW(zero_distribution({0.0}, {0.0, 190.0}), InputError);
  IntensityDistribution d = uniform_distribution(90.0, 90.0);
  d.at(2, 1) = -1.0;
  EXPECT_EQ(grid_fault(d), "intensity -1 at C 180 gamma 90");
  d.at(2, 1) = std::nan("");
  EXPECT_NE(grid_fault(d), "");
}

TEST(IntensityGrid, InterpolatesBilinearlyRoundTheCircle) {
  IntensityDistribution d = zero_distribution({0.0, 90.0, 270.0}, {0.0, 90.0});
  d.cd = {0.0, 10.0, 0.0, 20.0, 0.0, 40.0};
  EXPECT_DOUBLE_EQ(intensity_at(d, 45.0, 90.0), 15.0);
  EXPECT_DOUBLE_EQ(intensity_at(d, 315.0, 90.0), 25.0);
  EXPECT_DOUBLE_EQ(intensity_at(d, -45.0, 90.0), 25.0);
  EXPECT_DOUBLE_EQ(intensity_at(d, 360.0, 45.0), 5.0);
  EXPECT_DOUBLE_EQ(intensity_at(d, 180.0, 90.0), 30.0);
  EXPECT_DOUBLE_EQ(intensity_at(d, 0.0, 90.5), 0.0);
  EXPECT_DOUBLE_EQ(intensity_in(d, Direction::from({0.0, 1.0, 0.0})), 20.0);
}

}  // namespace
}  // namespace lucerna
