// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/spectrum_sampler.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(SpectrumSampler, SharesFollowThePowerBetweenThePoints) {
  const SpectrumSampler sampler({{400.0F, 500.0F, 700.0F}, {0.0F, 2.0F, 0.0F}});  // 100 + 200 = 300
  EXPECT_NEAR(sampler.wavelength_nm(1.0 / 3.0), 500.0, 1e-3);
  EXPECT_NEAR(sampler.wavelength_nm(1.0 / 12.0), 450.0, 1e-3);  // a quarter of the first triangle's area
  EXPECT_NEAR(sampler.wavelength_nm(1.0 - 1.0 / 6.0), 600.0, 1e-3);
  double mean = 0.0;
  for (std::uint64_t i = 0; i < 4096; ++i) mean += static_cast<double>(sampler(i)) / 4096.0;
  EXPECT_NEAR(mean, (400.0 + 500.0 + 700.0) / 3.0, 0.1) << "of a triangle";
}

TEST(SpectrumSampler, FlatAndDegenerateTables) {
  EXPECT_NEAR(SpectrumSampler({{400.0F, 500.0F}, {1.0F, 1.0F}}).wavelength_nm(0.25), 425.0F, 1e-4);
  EXPECT_EQ(SpectrumSampler({{555.0F}, {1.0F}}).wavelength_nm(0.7), 555.0F);
  EXPECT_EQ(SpectrumSampler({{400.0F, 500.0F}, {0.0F, 0.0F}}).wavelength_nm(0.7), 400.0F);
  EXPECT_EQ(SpectrumSampler({{400.0F, 500.0F, 600.0F}, {0.0F, 0.0F, 1.0F}}).wavelength_nm(0.0), 500.0F);
}

// Uniform over 400 to 700 nm: the share below 475 nm is a quarter. 1e-6 false alarms at 4.9 sigma; draws that
// are linear in the power (a third below) are 190 sigma off. The same ray has the same wavelength.
TEST(SpectrumSamplerStatistical, GivesARayAWavelengthOfItsOwn) {
  const SpectrumSampler even({{400.0F, 700.0F}, {1.0F, 1.0F}});
  const int n = 1'000'000;
  int below = 0;
  for (int i = 0; i < n; ++i) below += even.of_ray(7, static_cast<std::uint64_t>(i)) < 475.0F ? 1 : 0;
  EXPECT_NEAR(below / static_cast<double>(n), 0.25, 4.9 * std::sqrt(0.25 * 0.75 / n));
  EXPECT_EQ(even.of_ray(7, 5), even.of_ray(7, 5));
  EXPECT_NE(even.of_ray(7, 5), even.of_ray(8, 5));
}

}  // namespace
}  // namespace lucerna
