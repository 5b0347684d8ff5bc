// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/field_comparison.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

/// A Lambertian square of `side` mm about (x, 0, 0); weights spread over a factor of 5.
RayBlock square(std::size_t n, std::uint64_t seed, double side = 2.0, double x = 0.0) {
  RayBlock rays;
  rays.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(seed, i);
    const double px = x + side * (rng.uniform() - 0.5), py = side * (rng.uniform() - 0.5);
    const double s = std::sqrt(rng.uniform()), turn = 2.0 * std::numbers::pi * rng.uniform();
    rays.set(i, {{px, py, 0.0},
                 Direction::from({s * std::cos(turn), s * std::sin(turn), std::sqrt(1.0 - s * s)})});
    rays.weight[i] = static_cast<float>(0.5 + 2.0 * rng.uniform());
  }
  return rays;
}

std::vector<PlaneDifference> plane(const RayBlock& a, const RayBlock& b, const std::vector<double>& cells) {
  return focus_plane_differences(Views(a), a, b, cells);
}

FieldCorrelations correlations(const RayBlock& a, const RayBlock& b) {
  const Views views(a);
  ViewCounts p(views), q(views);
  p.add(a);
  q.add(b);
  return field_correlations(p, q, a, b);
}

TEST(FocusPlaneStatistical, RaysOfOneSourceDifferByTheFloor) {
  // The floor is one draw of the same statistic: a sum over 700 cells and more, whose spread is a few per
  // cent of itself; 20 % is more than 5 standard deviations.
  const std::vector<double> cells{24.0, 48.0, 75.0};
  for (const PlaneDifference& d : plane(square(60'000, 1), square(30'000, 2), cells)) {
    EXPECT_NEAR(d.l1 / d.floor, 1.0, 0.2) << d.cell_um;
    EXPECT_GT(d.floor, 0.0);
  }
  // A square 3 % wider leaves the floor behind, most clearly in wide cells.
  const PlaneDifference wider = plane(square(60'000, 1), square(30'000, 2, 2.06), {200.0}).front();
  EXPECT_GT(wider.l1, 1.5 * wider.floor);
}

TEST(FocusPlane, TheSumOfDifferencesIsTheOneThatIsKnown) {
  const RayBlock a = square(60'000, 3);
  // Unequal weights do not matter, nor does their scale.
  RayBlock heavy = square(60'000, 4);
  for (float& w : heavy.weight) w *= 1e-3f;
  EXPECT_LT(plane(a, heavy, {1000.0}).front().l1, 0.08);
  EXPECT_EQ(plane(a, a, {50.0}).front().l1, 0.0);
  // A square half beside the other: half of the light of each has no counterpart.
  EXPECT_NEAR(plane(a, square(60'000, 5, 2.0, 1.0), {1000.0}).front().l1, 1.0, 0.02);
  EXPECT_NEAR(plane(a, square(60'000, 5, 2.0, 5.0), {240.0}).front().l1, 2.0, 1e-9);
  EXPECT_THROW(plane(a, a, {0.0}), UsageError);
  EXPECT_THROW(plane(a, RayBlock(), {10.0}), InputError);
}

TEST(FieldCorrelationsStatistical, EqualSourcesReachTheNoiseLimitAndOthersDoNot) {
  const RayBlock a = square(80'000, 6);
  const FieldCorrelations same = correlations(a, square(60'000, 7)),
                          other = correlations(a, square(60'000, 8, 6.0));
  for (const auto& field : {same.near, same.mid, same.far}) {
    ASSERT_TRUE(field);
    EXPECT_NEAR(field->value, field->noise_limit, 0.02);
    EXPECT_GT(field->noise_limit, 0.7);
  }
  EXPECT_LT(other.near->value, same.near->value - 0.05);
  EXPECT_LT(other.mid->value, same.mid->value - 0.002);
  // Directions are the same.
  EXPECT_NEAR(other.far->value, other.far->noise_limit, 0.02);
  EXPECT_GT(same.mid_plane_mm, 3.9);
  const FieldCorrelations itself = correlations(a, a);
  for (const auto& field : {itself.near, itself.mid, itself.far}) EXPECT_NEAR(field->value, 1.0, 1e-12);
}

TEST(LuminanceImageStatistical, ALambertianSquareIsEquallyBrightAndAsWideAsItIs) {
  const RayBlock a = square(400'000, 9), b = square(400'000, 10, 1.0);
  const Views views(a);
  const auto image = luminance_image(views, a, b, Viewpoint::front);
  ASSERT_TRUE(image);
  const double cell_mm = (image->window.high[0] - image->window.low[0]) / LuminanceImage::kCells;
  double sum = 0.0, smaller = 0.0;
  int n = 0, m = 0;
  for (std::size_t x = 0; x < LuminanceImage::kCells; ++x) {
    for (std::size_t y = 0; y < LuminanceImage::kCells; ++y) {
      const auto at = [&](std::size_t k, std::size_t i) {
        return std::abs(image->window.low[k] + (static_cast<double>(i) + 0.5) * cell_mm);
      };
      const double reach = std::max(at(0, x), at(1, y)) + cell_mm;
      if (reach < 1.0) {
        sum += image->reference[x * LuminanceImage::kCells + y];
        ++n;
      }
      if (reach < 0.5) {
        smaller += image->test[x * LuminanceImage::kCells + y];
        ++m;
      }
    }
  }
  // Flux over pi A; some 26,800 rays go into the cone: 1 % is 1.6 standard deviations, weights counted.
  EXPECT_NEAR(sum / n * std::numbers::pi * 4.0, 1.0, 0.05);
  EXPECT_NEAR(smaller / m * std::numbers::pi * 1.0, 1.0, 0.05);
  EXPECT_FALSE(luminance_image(views, square(10'000, 11), b, Viewpoint::side)) << "hardly any light that way";
}

TEST(FieldComparison, SameBitsForAnyNumberOfThreads) {
  const RayBlock a = square(140'000, 12), b = square(70'000, 13);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return std::pair(plane(a, b, {30.0}).front(), correlations(a, b));
  };
  const auto one = run(1), two = run(2);
  EXPECT_EQ(one.first.l1, two.first.l1);
  EXPECT_EQ(one.first.floor, two.first.floor);
  EXPECT_EQ(one.second.mid->value, two.second.mid->value);
}

}  // namespace
}  // namespace lucerna
