// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/error_boxes.h"

#include <gtest/gtest.h>

#include <numbers>
#include <numeric>

#include "lucerna/random.h"

namespace lucerna {
namespace {

TargetRectangle boxes_downwards(double u_min, double u_max, double v_min, double v_max) {
  return {Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), false, u_min, u_max, v_min, v_max};
}

TEST(ErrorBoxes, SolidAnglesFillTheSphere) {
  for (const TargetRectangle& r :
       {boxes_downwards(-0.3, 0.25, -0.1, 0.12), boxes_downwards(-1, 1, -1, 1),
        boxes_downwards(0.2, 0.98, -0.5, 0.5), boxes_downwards(-0.001, 0.001, 0.0, 0.001)}) {
    const ErrorBoxes boxes(r);
    const auto& m = boxes.measure();
    // Slivers at the horizon are left out: hundredths of the cells along it.
    EXPECT_NEAR(std::accumulate(m.begin(), m.end(), 0.0) / (4.0 * std::numbers::pi), 1.0, 2e-3) << r.u_min;
    EXPECT_LT(boxes.size(), 200000u);
  }
}

TEST(ErrorBoxes, ALambertianEmittersFluxIsTheAreaOfDirectionCosines) {
  const ErrorBoxes boxes(boxes_downwards(-0.4, 0.8, -0.3, 0.7));
  const auto flux = boxes.flux_of([](const Direction& d) { return std::max(0.0, -d.z()); }, 0.02);
  const double step_u = 1.2 / kErrorBoxes, step_v = 1.0 / kErrorBoxes;
  double partly = 0.0;
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    const double u = -0.4 + (static_cast<double>(b % kErrorBoxes) + 1.0) * step_u;
    const double v = -0.3 + (static_cast<double>(b / kErrorBoxes) + 1.0) * step_v;
    // The corner farthest from the axis, and the nearest one.
    const double far =
        std::hypot(std::max(std::abs(u), std::abs(u - step_u)), std::max(std::abs(v), std::abs(v - step_v)));
    if (far < 1.0) {
      EXPECT_NEAR(flux[b] / (step_u * step_v), 1.0, 1e-5) << b;
    }
    if (far >= 1.0) partly += flux[b];
    if (std::hypot(u - step_u, v - step_v) > 1.0 && u > step_u && v > step_v) {
      EXPECT_EQ(flux[b], 0.0) << b;
    }
  }
  EXPECT_GT(partly, 0.0);
  // Together with the cells outside: the whole disc.
  EXPECT_NEAR(std::accumulate(flux.begin(), flux.end(), 0.0), std::numbers::pi, 1e-4);
}

TEST(ErrorBoxesStatistical, DirectionsFallIntoTheCellsThatWereIntegrated) {
  // Uniform directions: counts follow the measure. Chi^2 over the cells with enough of them, false alarm
  // 1e-6.
  for (const TargetRectangle& r :
       {boxes_downwards(-0.5, 0.4, 0.1, 0.9), boxes_downwards(-0.01, 0.01, 0.3, 0.32)}) {
    const ErrorBoxes boxes(r);
    constexpr int kCount = 2000000;
    std::vector<double> count(boxes.size(), 0.0);
    Rng rng(7, 0);
    for (int i = 0; i < kCount; ++i) {
      const double z = 2.0 * rng.uniform() - 1.0, phi = 2.0 * std::numbers::pi * rng.uniform();
      const double s = std::sqrt(1.0 - z * z);
      count[boxes.cell({}, {s * std::cos(phi), s * std::sin(phi), z})] += 1.0;
    }
    double chi2 = 0.0, freedom = 0.0;
    for (std::size_t c = 0; c < boxes.size(); ++c) {
      const double expected = kCount * boxes.measure()[c] / (4.0 * std::numbers::pi);
      if (expected < 20.0) continue;
      chi2 += (count[c] - expected) * (count[c] - expected) / expected;
      freedom += 1.0;
    }
    EXPECT_GT(freedom, 100.0);
    EXPECT_LT(chi2, freedom + 4.75 * std::sqrt(2.0 * freedom)) << freedom;
  }
}

TEST(ErrorBoxes, OfAPlaneTakesPlacesAndCountsTheRestApart) {
  const ErrorBoxes boxes({Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {10, 0, -1000}), true, -48, 48, -24, 24});
  EXPECT_DOUBLE_EQ(boxes.measure()[0], 2.0);
  const Vec3 from{10, 0, 0};
  EXPECT_EQ(boxes.cell(from, {0, 0, -1}), 24u * kErrorBoxes + 24u);
  const Direction corner = Direction::from({-47.5, -23.6, -1000});
  EXPECT_EQ(boxes.cell(from, corner), 0u);
  const Direction beside = Direction::from({60, 0, -1000});
  EXPECT_GE(boxes.cell(from, beside), ErrorBoxes::kInside);
  EXPECT_GT(boxes.measure()[boxes.cell(from, beside)], 0.0);
  const Direction away = Direction::from({0, 0, 1}), far = Direction::from({1000, 0, -1});
  EXPECT_EQ(boxes.cell(from, away), boxes.size() - 1);
  EXPECT_EQ(boxes.cell(from, far), boxes.size() - 1);
  EXPECT_EQ(boxes.measure().back(), 0.0);
  const auto flux = boxes.flux_on([](double x, double) { return x + 48.0; }, 1.0);
  EXPECT_NEAR(flux[0], 2.0 * 1.0, 1e-12);
  EXPECT_NEAR(flux[47], 2.0 * 95.0, 1e-10);
}

}  // namespace
}  // namespace lucerna
