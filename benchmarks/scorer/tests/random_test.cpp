// SPDX-License-Identifier: Apache-2.0
#include "random.h"

#include <gtest/gtest.h>

#include <cmath>

namespace bench {
namespace {

// The words that the authors of the generator publish for counter 0 and key 0 (Random123, kat_vectors).
TEST(Random, IsPhilox) {
  RayRandom r(0, 0);
  EXPECT_EQ(r.uniform(), 0x1p-53 * static_cast<double>(0xE169C58D6627E8D5u >> 11));
  EXPECT_EQ(r.uniform(), 0x1p-53 * static_cast<double>(0x9B00DBD8BC57AC4Cu >> 11));
}

TEST(Random, DependsOnSeedAndRay) {
  const double a = RayRandom(1, 5).uniform();
  EXPECT_EQ(a, RayRandom(1, 5).uniform());
  EXPECT_NE(a, RayRandom(1, 6).uniform());
  EXPECT_NE(a, RayRandom(2, 5).uniform());
  EXPECT_NE(a, RayRandom(1, 5 + (std::uint64_t{1} << 32)).uniform());
}

// Mean and variance of 1e5 numbers within five standard errors: 0.0046 and 0.0012.
TEST(RandomStatistical, IsEven) {
  double sum = 0.0, square = 0.0;
  constexpr int kRays = 1000, kDraws = 100;
  for (int ray = 0; ray < kRays; ++ray) {
    RayRandom r(3, static_cast<std::uint64_t>(ray));
    for (int k = 0; k < kDraws; ++k) {
      const double x = r.uniform() - 0.5;
      sum += x;
      square += x * x;
    }
  }
  constexpr double n = kRays * kDraws;
  EXPECT_NEAR(sum / n, 0.0, 5.0 * std::sqrt(1.0 / 12.0 / n));
  EXPECT_NEAR(square / n, 1.0 / 12.0, 5.0 * std::sqrt(1.0 / 180.0 / n));
}

}  // namespace
}  // namespace bench
