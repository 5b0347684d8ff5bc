// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"
#include "lucerna/ray_comparison.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

/// A Lambertian disk of radius 1 mm in z = 0, or one that is `stretch` times as wide; weights spread over a
/// factor of 5.
RayBlock disk(std::size_t n, std::uint64_t seed, double stretch = 1.0) {
  RayBlock rays;
  rays.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    const double r = stretch * std::sqrt(rng.uniform()), phi = 2.0 * std::numbers::pi * rng.uniform();
    const double s = std::sqrt(rng.uniform()), turn = 2.0 * std::numbers::pi * rng.uniform();
    rays.set(i, {{r * std::cos(phi), r * std::sin(phi), 0.0},
                 Direction::from({s * std::cos(turn), s * std::sin(turn), std::sqrt(1.0 - s * s)})});
    rays.weight[i] = static_cast<float>(0.5 + 2.0 * rng.uniform());
  }
  return rays;
}

/// error^2 - floor^2 in units of its standard deviation under "no difference", (standard error of a zero
/// excess)^2.
double deviation(const ViewDifference& d) {
  const double spread = d.excess > 0.0
                            ? std::max(d.standard_error * d.standard_error, 2.0 * d.excess * d.standard_error)
                            : d.standard_error * d.standard_error;
  return (d.error * d.error - d.floor * d.floor) / spread;
}

// The calibration of every quality figure: independent rays of one source show no excess, beyond noise, in
// any view. Ten pairs of sets and five views; |deviation| < 6 is a false alarm below 1e-6 for the sum over
// cells, nearly normal.
TEST(CompareStatistical, IndependentRaysOfOneSourceHaveNoExcess) {
  std::array<double, 5> mean{};
  constexpr int kPairs = 10;
  for (int pair = 0; pair < kPairs; ++pair) {
    const auto seed = static_cast<std::uint64_t>(100 + 2 * pair);
    const RaySetComparison c = compare_ray_sets(disk(200'000, seed), disk(120'000, seed + 1));
    for (const ViewKind kind : kViewKinds) {
      EXPECT_LT(std::abs(deviation(c[kind])), 6.0) << to_string(kind);
      EXPECT_LT(c[kind].excess, 4.0 * c[kind].standard_error) << to_string(kind);
      mean[static_cast<std::size_t>(kind)] += deviation(c[kind]) / kPairs;
    }
  }
  // Nor on average: the mean of ten has a tenth of the variance.
  for (const ViewKind kind : kViewKinds) {
    EXPECT_LT(std::abs(mean[static_cast<std::size_t>(kind)]), 6.0 / std::sqrt(kPairs)) << to_string(kind);
  }
}

TEST(CompareStatistical, ADiskFivePerCentWiderIsSeenWhereItShows) {
  const RaySetComparison c = compare_ray_sets(disk(200'000, 1), disk(120'000, 2, 1.05));
  for (const ViewKind kind : {ViewKind::focus, ViewKind::beam, ViewKind::four_d}) {
    EXPECT_GT(deviation(c[kind]), 6.0) << to_string(kind);
    EXPECT_GT(c[kind].excess, 3.0 * c[kind].standard_error) << to_string(kind);
  }
  // Directions are the same: the far field must not show it.
  EXPECT_LT(std::abs(deviation(c.far)), 6.0);
}

TEST(CompareStatistical, ExcessIsTheTrueDifferenceWhateverTheNumberOfRays) {
  // Scaling every start by 1.2 about the focus changes shares by a fixed amount; more rays only sharpen it.
  const RaySetComparison few = compare_ray_sets(disk(100'000, 11), disk(100'000, 12, 1.2));
  const RaySetComparison many = compare_ray_sets(disk(800'000, 13), disk(800'000, 14, 1.2));
  EXPECT_NEAR(few.focus.excess, many.focus.excess,
              6.0 * (few.focus.standard_error + many.focus.standard_error) + 0.01);
  EXPECT_NEAR(few.focus.floor / many.focus.floor, std::sqrt(8.0), 0.1);
}

TEST(Compare, FloorAndRawAreCountingNoise) {
  // 1000 equal rays against 1000: variance 2 / 1000 of the total share, relative to the norm.
  RayBlock a = disk(1000, 3), b = disk(1000, 4), t = disk(250, 5);
  for (RayBlock* rays : {&a, &b, &t}) rays->weight.assign(rays->size(), 2.0f);
  const RaySetComparison c = compare_ray_sets(a, b, &t);
  EXPECT_NEAR(c.far.raw / c.far.floor, std::sqrt(4.0 / 2.0), 1e-9);
  EXPECT_NEAR(compare_ray_sets(a, b).far.raw / c.far.floor, std::sqrt(0.5), 1e-9);
}

TEST(Compare, SameBitsForAnyNumberOfThreads) {
  const RayBlock a = disk(600'000, 6), b = disk(300'000, 7);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return compare_ray_sets(a, b);
  };
  const RaySetComparison one = run(1), two = run(2);
  for (const ViewKind kind : kViewKinds) {
    EXPECT_EQ(one[kind].error, two[kind].error);
    EXPECT_EQ(one[kind].standard_error, two[kind].standard_error);
  }
}

}  // namespace
}  // namespace lucerna
