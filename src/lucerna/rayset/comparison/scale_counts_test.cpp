// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/scale_counts.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

/// A Lambertian square of 2 mm with stripes along x of 0.5 mm period.
RayBlock striped_square(std::size_t n, std::uint64_t seed, double contrast) {
  RayBlock rays;
  rays.resize(n);
  std::uint64_t number = 0;
  for (std::size_t i = 0; i < n;) {
    Rng rng(seed, number++);
    const double x = 2.0 * rng.uniform() - 1.0, y = 2.0 * rng.uniform() - 1.0;
    if (2.0 * rng.uniform() > 1.0 + contrast * std::sin(4.0 * std::numbers::pi * y)) continue;
    const double s = std::sqrt(rng.uniform()), turn = 2.0 * std::numbers::pi * rng.uniform();
    rays.set(
        i, {{x, y, 0.0}, Direction::from({s * std::cos(turn), s * std::sin(turn), std::sqrt(1.0 - s * s)})});
    rays.weight[i++] = 1.0f;
  }
  return rays;
}

std::array<ScaleDifference, 5> scales_of(const RayBlock& reference, const RayBlock& test) {
  const Views views(reference);
  ScaleCounts a(views), b(views);
  a.add(reference);
  b.add(test);
  return compare_scales(a, b, a);
}

TEST(ScaleCounts, OneSourceHasNoExcessAtAnyScale) {
  const auto scales = scales_of(striped_square(200'000, 1, 0.2), striped_square(150'000, 2, 0.2));
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_LT(scales[k].difference.excess, 4.0 * scales[k].difference.standard_error);
    if (k > 0) {
      EXPECT_NEAR(scales[k].cell_mm, 2.0 * scales[k - 1].cell_mm, 1e-12);
      // Noise of sums falls as the root of what is summed.
      EXPECT_NEAR(scales[k].difference.raw / scales[k - 1].difference.raw, 0.5, 0.05);
    }
  }
}

TEST(ScaleCounts, StripesShowAtScalesBelowTheirPeriod) {
  const auto scales = scales_of(striped_square(200'000, 3, 0.2), striped_square(200'000, 4, 0.0));
  for (std::size_t k = 0; k < 3; ++k) {
    // The root mean square of the stripes, relative, as cells see it.
    const double phase = std::numbers::pi * scales[k].cell_mm / 0.5;
    const double expected = 0.2 / std::numbers::sqrt2 * std::sin(phase) / phase;
    EXPECT_NEAR(scales[k].difference.excess, expected, 4.0 * scales[k].difference.standard_error);
    EXPECT_GT(scales[k].difference.excess, 3.0 * scales[k].difference.standard_error);
  }
}

TEST(ScaleCounts, SameBitsForAnyNumberOfThreads) {
  const RayBlock a = striped_square(300'000, 5, 0.1);
  const Views views(a);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    ScaleCounts counts(views);
    counts.add(a);
    return counts.weights();
  };
  EXPECT_EQ(run(1), run(2));
}

}  // namespace
}  // namespace lucerna
