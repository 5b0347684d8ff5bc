// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/radius_choice.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lucerna {
namespace {

constexpr std::size_t kDraws = 16;

/// `mean` with a standard error of `error`; neighbours of another `phase` have other noise.
Jackknife noisy(double mean, double error, std::size_t phase) {
  Jackknife out(kDraws);
  for (std::size_t r = 0; r < out.values().size(); ++r)
    out.values()[r] = mean + (r == 0 ? 0.0 : std::sin(1.7 * static_cast<double>(r * (phase + 1))));
  return out.with_error(error);
}

RadiusChoice added(const std::vector<Estimate>& from_wide_to_narrow) {
  RadiusChoice choice;
  for (std::size_t i = 0; i < from_wide_to_narrow.size(); ++i) {
    const Estimate& e = from_wide_to_narrow[i];
    choice.add(noisy(e.mean, e.standard_error, i), e.standard_error);
  }
  return choice;
}

TEST(RadiusChoice, AWideKernelWinsWhereNarrowOnesAgree) {
  const auto best = added({{100.0, 1.0}, {101.0, 2.0}, {97.0, 4.0}}).best();
  EXPECT_EQ(best.index, 0u);
  EXPECT_DOUBLE_EQ(best.error, 1.0);
  EXPECT_DOUBLE_EQ(best.noise, 1.0);
}

// A cone's tip of 100: what a kernel leaves out is in proportion to its radius.
TEST(RadiusChoice, BiasIsSeenAndStated) {
  const auto best = added({{84.0, 0.05}, {92.0, 0.1}, {96.0, 0.2}, {98.0, 0.4}}).best();
  EXPECT_EQ(best.index, 3u);
  EXPECT_DOUBLE_EQ(best.noise, 0.4);
  EXPECT_NEAR(best.error, 2.0, 0.4);
  EXPECT_NEAR(best.values.estimate().standard_error, best.error, 1e-9);
}

TEST(RadiusChoice, EndsWhereNarrowerKernelsOnlyAddNoise) {
  EXPECT_FALSE(added({{100.0, 1.0}}).complete());
  EXPECT_FALSE(added({{100.0, 1.0}, {100.0, 4.0}}).complete());
  EXPECT_FALSE(added({{100.0, 1.0}, {100.0, 2.0}, {100.0, 2.5}}).complete());
  EXPECT_TRUE(added({{100.0, 1.0}, {100.0, 2.0}, {100.0, 4.0}}).complete());
}

TEST(RadiusChoice, WithoutErrorsTheWidestIsTaken) {
  RadiusChoice choice;
  choice.add(Jackknife(std::vector<double>{5.0}), std::nan(""));
  EXPECT_TRUE(choice.complete());
  EXPECT_EQ(choice.best().values.all(), 5.0);
  EXPECT_TRUE(std::isnan(choice.best().error));
}

}  // namespace
}  // namespace lucerna
