// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/graded_bins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "lucerna/random.h"

namespace lucerna {
namespace {

TargetRectangle down(double u_min, double u_max, double v_min, double v_max) {
  return {Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), false, u_min, u_max, v_min, v_max};
}

TEST(GradedBins, CoverTheHemisphere) {
  const TentBins bins = graded_bins(down(-0.2, 0.4, -0.1, 0.1), Frame(), 48, 1.25);
  const double whole = std::accumulate(bins.measure().begin(), bins.measure().end(), 0.0);
  EXPECT_NEAR(whole, 2.0 * std::numbers::pi, 0.1);
}

TEST(GradedBins, LoseNoLightOfAnyDirection) {
  const TentBins bins = graded_bins(down(-0.2, 0.4, -0.1, 0.1), Frame(), 48, 1.25);
  Rng rng(3, 0);
  for (int i = 0; i < 2000; ++i) {
    const double z = 0.01 + 0.99 * rng.uniform(), a = 2.0 * std::numbers::pi * rng.uniform(),
                 s = std::sqrt(1 - z * z);
    TentDeposit d;
    bins.deposit({}, Vec3{s * std::cos(a), s * std::sin(a), -z}, d);
    double sum = 0.0;
    for (int k = 0; k < d.n; ++k) sum += d.weight[static_cast<std::size_t>(k)];
    EXPECT_NEAR(sum, 1.0, 1e-12) << z << ' ' << a;
  }
}

TEST(GradedBins, DerivativesAreThoseOfTheWeightsInsideAndOutsideTheWindow) {
  const TentBins bins = graded_bins(down(-0.2, 0.4, -0.1, 0.1), Frame(), 48, 1.25);
  for (const Vec3 at : {Vec3{0.1, 0.03, 0}, Vec3{0.7, -0.4, 0}, Vec3{-0.5, 0.6, 0}}) {
    const auto weights = [&](double u, double v) {
      TentDeposit d;
      bins.deposit({}, Vec3{u, -v, -std::sqrt(1 - u * u - v * v)}, d);
      return d;
    };
    constexpr double kStep = 1e-7;
    const TentDeposit here = weights(at.x, at.y), right = weights(at.x + kStep, at.y),
                      left = weights(at.x - kStep, at.y);
    ASSERT_EQ(here.n, 4);
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(right.bin[k], left.bin[k]);
      EXPECT_NEAR((right.weight[k] - left.weight[k]) / (2 * kStep), here.du[k],
                  1e-4 * (1.0 + std::abs(here.du[k])));
    }
  }
}

TEST(GradedBins, RectangleIsWhatTheTargetHolds) {
  const TargetRectangle r = down(-0.2, 0.4, -0.1, 0.1);
  const TentBins bins = graded_bins(r, Frame(), 50, 1.25);
  const Eigen::VectorXd inside = in_rectangle(bins, r);
  EXPECT_EQ(inside.sum(), 40 * 40);
  double solid_angle = 0.0;
  for (std::size_t b = 0; b < bins.size(); ++b)
    solid_angle += inside[static_cast<Eigen::Index>(b)] * bins.measure()[b];
  EXPECT_NEAR(solid_angle, 0.6 * 0.2, 0.05 * 0.12);
}

TEST(GradedBins, ReachBeyondThePlanesRectangle) {
  const TargetRectangle r{Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1000}), true, -300, 300, -200, 200};
  const TentBins bins = graded_bins(r, Frame(), 40, 1.25);
  TentDeposit d;
  bins.deposit({0, 0, 0}, Direction::from({0.6, 0.0, -1.0}), d);  // 600 mm off the middle
  EXPECT_EQ(d.n, 4);
}

}  // namespace
}  // namespace lucerna
