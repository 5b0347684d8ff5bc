// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/free_form_levels.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(FreeFormLevels, NoiseTakesBinsAndItsAbsenceTakesDerivatives) {
  const FreeFormLevel all = free_form_level(2);
  EXPECT_EQ(for_noise(all, 0.0).derivative_rays, all.rays / 8);
  EXPECT_EQ(for_noise(all, 0.02).derivative_rays, all.rays / 2);
  EXPECT_EQ(for_noise(all, 0.2).derivative_rays, all.rays);
  EXPECT_EQ(for_noise(all, 0.2).bins, all.bins);
  EXPECT_EQ(for_noise(all, 0.6).bins, 76);  // bins and cells that share rays: by the root of the noise
  EXPECT_EQ(for_noise(all, 1e9).bins, 65);
  for (double noise = 0.001; noise < 100.0; noise *= 1.3) {
    const FreeFormLevel l = for_noise(all, noise), more = for_noise(all, 1.3 * noise);
    EXPECT_LE(more.bins, l.bins) << noise;
    EXPECT_LE(l.derivative_rays, l.rays) << noise;
  }
}

TEST(FreeFormLevels, DerivativesOfFewRaysAreThoseOfAll) {
  FreeFormLevel few = free_form_level(1);
  few.rays = 1 << 15;
  EXPECT_EQ(for_noise(few, 0.0).derivative_rays, few.rays);
}

}  // namespace
}  // namespace lucerna
