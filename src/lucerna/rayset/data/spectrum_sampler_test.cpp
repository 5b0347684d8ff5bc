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
}

TEST(SpectrumSampler, FlatAndDegenerateTables) {
  EXPECT_NEAR(SpectrumSampler({{400.0F, 500.0F}, {1.0F, 1.0F}}).wavelength_nm(0.25), 425.0F, 1e-4);
  EXPECT_EQ(SpectrumSampler({{555.0F}, {1.0F}}).wavelength_nm(0.7), 555.0F);
  EXPECT_EQ(SpectrumSampler({{400.0F, 500.0F}, {0.0F, 0.0F}}).wavelength_nm(0.7), 400.0F);
  EXPECT_EQ(SpectrumSampler({{400.0F, 500.0F, 600.0F}, {0.0F, 0.0F, 1.0F}}).wavelength_nm(0.0), 500.0F);
}

}  // namespace
}  // namespace lucerna
