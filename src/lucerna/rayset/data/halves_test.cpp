// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/halves.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

TEST(RayHalves, HoldEveryRayOnceInItsOrder) {
  const RaySet set = test::random_ray_set(1000, 3, {{ColumnKind::wavelength_nm, "wavelength"}});
  const auto halves = ray_halves(set.rays, 7);
  std::array<std::size_t, 2> at{};
  for (std::size_t i = 0; i < set.rays.size(); ++i) {
    const std::size_t half = in_second_half(7, i) ? 1 : 0, k = at[half]++;
    ASSERT_LT(k, halves[half].size());
    EXPECT_EQ(halves[half].x_mm[k], set.rays.x_mm[i]);
    EXPECT_EQ(halves[half].extra[0][k], set.rays.extra[0][i]);
  }
  EXPECT_EQ(at[0], halves[0].size());
  EXPECT_EQ(at[1], halves[1].size());
}

// Four standard deviations of counts are passed by chance once in 16,000 times; the test of one seed is
// always the same. Halves in turns would put all of the even rays into one.
TEST(RayHalvesStatistical, FollowNoPattern) {
  constexpr std::size_t kRays = 40'000;
  for (const std::size_t period : {1U, 2U, 3U, 4U, 64U}) {
    std::size_t in_second = 0;
    for (std::size_t i = 0; i < kRays; ++i) in_second += in_second_half(1, i * period) ? 1 : 0;
    EXPECT_NEAR(static_cast<double>(in_second), 0.5 * kRays, 4.0 * std::sqrt(0.25 * kRays)) << period;
  }
}

// Rays of seed 1 are placed by Rng(1, i): halves by the same numbers would each be one side of the source.
TEST(RayHalvesStatistical, DoNotFollowTheNumbersThatPlaceRays) {
  constexpr std::size_t kRays = 40'000;
  std::size_t with = 0;
  for (std::size_t i = 0; i < kRays; ++i)
    with += in_second_half(1, i) == (Rng(1, i).uniform() >= 0.5) ? 1 : 0;
  EXPECT_NEAR(static_cast<double>(with), 0.5 * kRays, 4.0 * std::sqrt(0.25 * kRays));
}

}  // namespace
}  // namespace lucerna
