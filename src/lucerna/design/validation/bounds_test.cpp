// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/bounds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace lucerna {
namespace {

/// A Lambertian source of even luminance: the share of its flux grows with the etendue until all is in.
EtendueCurve even(double etendue_mm2sr) { return EtendueCurve({{0.0, 0.0}, {1.0, etendue_mm2sr}}); }

const Vec3 kNadir{0, 0, -1};

struct Spot {
  ErrorBoxes boxes;
  std::vector<double> target;
};

/// Two levels: a square core, a quarter as wide as the rectangle, with `core` of the light.
Spot two_levels(double half, double core) {
  Spot s{ErrorBoxes({Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), false, -half, half, -half, half}), {}};
  s.target.assign(s.boxes.size(), 0.0);
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    const std::size_t u = b % kErrorBoxes, v = b / kErrorBoxes;
    const bool in = u >= 18 && u < 30 && v >= 18 && v < 30;
    s.target[b] = in ? core / 144.0 : (1.0 - core) / (2304.0 - 144.0);
  }
  return s;
}

TEST(Bounds, NothingForbidsWhatFits) {
  const Spot s = two_levels(0.1, 0.9);
  // The opening towards the core: 1000 mm2 * 0.05^2 = 2.5 mm2 sr; 0.9 of 2 mm2 sr fits.
  const DesignBound b =
      etendue_bound(s.boxes, s.target, TargetMode::shape, 1.0, even(2.0), kNadir, 1000.0, 0.0);
  EXPECT_EQ(b.error, 0.0);
}

TEST(Bounds, TheCoreTakesNoMoreThanItsEtendue) {
  const Spot s = two_levels(0.1, 0.9);
  // Of 5 mm2 sr half fits, and 5 per cent are granted: with s f having at most s * 0.525 in the core and the
  // rest outside, the least of the two deviations; found here by trying scales.
  const double core_sr = 0.05 * 0.05, rest_sr = 0.2 * 0.2 - core_sr, max = 0.525;
  double min = 1e9;
  for (double scale = 0.0; scale < 3.0; scale += 1e-4) {
    const double in = std::max(0.0, 0.9 - scale * max), out = std::max(0.0, scale * (1.0 - max) - 0.1);
    min = std::min(min, in * in / core_sr + out * out / rest_sr);
  }
  const double expected = std::sqrt(min / (0.81 / core_sr + 0.01 / rest_sr));
  const DesignBound b =
      etendue_bound(s.boxes, s.target, TargetMode::shape, 1.0, even(5.0), kNadir, 1000.0, 0.0);
  EXPECT_NEAR(b.error, expected, 0.02 * expected);
  EXPECT_GT(expected, 0.1);
  EXPECT_NEAR(b.target_share, 0.9, 0.02);
  EXPECT_NEAR(b.max_share, 0.525, 0.01);
  // Light may be discarded: with half of it in the rectangle the core's share fits.
  EXPECT_EQ(etendue_bound(s.boxes, s.target, TargetMode::shape, 0.5, even(5.0), kNadir, 1000.0, 0.0).error,
            0.0);
}

TEST(Bounds, AbsoluteTargetsAreBoundByTheirMissingLight) {
  const Spot s = two_levels(0.1, 0.9);
  const DesignBound b =
      etendue_bound(s.boxes, s.target, TargetMode::absolute, 0.1, even(5.0), kNadir, 1000.0, 0.0);
  const double core_sr = 0.05 * 0.05, rest_sr = 0.2 * 0.2 - core_sr;
  const double expected =
      std::sqrt((0.9 - 0.525) * (0.9 - 0.525) / core_sr / (0.81 / core_sr + 0.01 / rest_sr));
  EXPECT_NEAR(b.error, expected, 0.02 * expected);
}

TEST(Bounds, IsNeverAboveAnErrorThatLightOfTheEtendueHas) {
  // Light that fills the core's etendue and spreads the rest evenly obeys all laws: its error is no lower.
  const Spot s = two_levels(0.1, 0.9);
  for (const double etendue : {3.0, 5.0, 10.0, 50.0}) {
    const DesignBound b =
        etendue_bound(s.boxes, s.target, TargetMode::shape, 1.0, even(etendue), kNadir, 1000.0, 0.0);
    const double core = std::min(0.9, 2.5 / etendue);
    BoxSums light;
    light.flux.assign(s.boxes.size(), 0.0);
    for (std::size_t k = 0; k < ErrorBoxes::kInside; ++k) {
      const bool in = s.target[k] > 0.005;
      light.flux[k] = in ? core / 144.0 : (1.0 - core) / (2304.0 - 144.0);
    }
    light.emitted = light.out_reflected = 1.0;
    const DesignError e = box_error(s.boxes, s.target, std::vector{light}, TargetMode::shape);
    EXPECT_LE(b.error, e.c48.value + 1e-9) << etendue;
  }
}

}  // namespace
}  // namespace lucerna
