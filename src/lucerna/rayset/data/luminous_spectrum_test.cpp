// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/luminous_spectrum.h"

#include <gtest/gtest.h>

#include <numeric>

namespace lucerna {
namespace {

// The integral that CIE 15 states for the table each 5 nm, and values of the table each 10 nm.
TEST(LuminousEfficiency, IsThatOfTheCie) {
  double sum = 0.0;
  for (double nm = 380.0; nm <= 780.0; nm += 5.0) sum += 5.0 * luminous_efficiency(nm);
  EXPECT_NEAR(sum, 106.857, 0.001);
  EXPECT_EQ(luminous_efficiency(555.0), 1.0);
  EXPECT_EQ(luminous_efficiency(510.0), 0.503);
  EXPECT_EQ(luminous_efficiency(610.0), 0.503);
  EXPECT_NEAR(luminous_efficiency(557.5), 0.9975, 1e-12) << "linear between";
  EXPECT_EQ(luminous_efficiency(379.9), 0.0);
  EXPECT_EQ(luminous_efficiency(780.1), 0.0);
}

TEST(LuminousSpectrum, ResolvesVBetweenThePointsOfATable) {
  const SpectralTable lumens = luminous_spectrum({{380.0F, 780.0F}, {2.0F, 2.0F}});
  ASSERT_EQ(lumens.wavelength_nm.size(), 81U);
  EXPECT_EQ(lumens.wavelength_nm.front(), 380.0F);
  EXPECT_EQ(lumens.wavelength_nm.back(), 780.0F);
  EXPECT_EQ(lumens.relative_power[35], 2.0F);
  const double sum = std::accumulate(lumens.relative_power.begin(), lumens.relative_power.end(), 0.0);
  EXPECT_NEAR(5.0 * sum, 2.0 * 106.857, 0.002);
}

// Whatever a file states: V ends at 780 nm, and so does the table between its points.
TEST(LuminousSpectrum, IsShortForHugeWavelengths) {
  const SpectralTable lumens = luminous_spectrum({{400.0F, 1e30F}, {1.0F, 1.0F}});
  EXPECT_LT(lumens.wavelength_nm.size(), 100U);
  EXPECT_EQ(lumens.relative_power.back(), 0.0F);
}

TEST(LuminousSpectrum, LeavesLinesAndInvisibleLightAsTheyAre) {
  const SpectralTable line{{450.0F}, {1.0F}}, infrared{{850.0F, 950.0F}, {1.0F, 0.5F}};
  EXPECT_EQ(luminous_spectrum(line), line);
  EXPECT_EQ(luminous_spectrum(infrared), infrared);
}

}  // namespace
}  // namespace lucerna
