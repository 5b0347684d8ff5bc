// SPDX-License-Identifier: Apache-2.0
#include "box_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace bench {
namespace {

constexpr std::size_t kCells = 400, kParts = 16;

/// Cells of a smooth target, and light of a known shape with normal noise of `noise` of the mean in each
/// cell.
CellLight made(double ripple, double noise, unsigned seed) {
  std::mt19937_64 words(seed);
  const auto normal = [&] {
    const double u = (static_cast<double>(words() >> 11) + 0.5) * 0x1p-53,
                 v = static_cast<double>(words() >> 11) * 0x1p-53;
    return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
  };
  CellLight c;
  c.by_replicate.resize(kParts);
  for (std::size_t i = 0; i < kCells; ++i) {
    const double x = static_cast<double>(i) / kCells;
    c.measure.push_back(1.0 + 0.5 * x);
    c.target.push_back((1.0 + x) * c.measure.back());
    const double light = 3.0 * c.target.back() * (1.0 + (i % 2 == 0 ? ripple : -ripple));
    for (auto& row : c.by_replicate)
      row.push_back(light * (1.0 + noise * std::sqrt(double{kParts}) * normal()));
  }
  return c;
}

// A ripple of +-r has the error r sqrt(1 - r^2 ...): with the best scale s = 1 / (1 + r^2) it is r / sqrt(1 +
// r^2).
TEST(BoxError, RippleHasItsError) {
  const BoxError e = box_error(made(0.1, 0.0, 1));
  EXPECT_NEAR(e.value, 0.1 / std::sqrt(1.01), 1e-3);
  EXPECT_NEAR(e.floor, 0.0, 1e-12);
  EXPECT_DOUBLE_EQ(e.value, e.excess);
  EXPECT_NEAR(box_error(made(0.0, 0.0, 1)).value, 0.0, 1e-12);
  EXPECT_NEAR(box_error(made(0.0, 0.0, 1)).scale, 1.0 / 3.0, 1e-12);
}

// Over 200 trials: E = value^2 - floor^2 has the mean of the true error squared within 5 standard errors, and
// the standard error that is printed is that of the scatter within a fifth.
TEST(BoxErrorStatistical, NoiseIsTakenOut) {
  for (const double ripple : {0.0, 0.02, 0.1}) {
    std::vector<double> squares, excesses;
    double stated = 0.0;
    constexpr unsigned kTrials = 200;
    for (unsigned k = 0; k < kTrials; ++k) {
      const BoxError e = box_error(made(ripple, 0.05, 100 + k));
      EXPECT_NEAR(e.floor, 0.05, 0.006);
      squares.push_back(e.value * e.value - e.floor * e.floor);
      excesses.push_back(e.excess);
      stated += e.standard_error / kTrials;
    }
    const Estimate mean = mean_of(squares);
    const double truth = ripple * ripple / (1.0 + ripple * ripple);
    EXPECT_NEAR(mean.mean, truth, 5.0 * mean.standard_error + 1e-5) << ripple;
    if (ripple < 0.1) continue;  // below, the excess is cut at 0 and its scatter is no sigma
    const double scatter = mean_of(excesses).standard_error * std::sqrt(double{kTrials});
    EXPECT_NEAR(stated / scatter, 1.0, 0.2) << ripple;
  }
}

TEST(BoxError, DarkResultIsAllError) {
  CellLight c = made(0.0, 0.0, 1);
  for (auto& row : c.by_replicate) row.assign(kCells, 0.0);
  EXPECT_DOUBLE_EQ(box_error(c).value, 1.0);
  EXPECT_EQ(absolute_error(c).value, 1.0);
}

TEST(BoxError, CellsWithoutMeasureDoNotCount) {
  CellLight c = made(0.1, 0.0, 1);
  const double before = box_error(c).value;
  c.measure.push_back(0.0);
  c.target.push_back(5.0);
  for (auto& row : c.by_replicate) row.push_back(77.0);
  EXPECT_EQ(box_error(c).value, before);
}

TEST(BoxError, BoxesMerge) {
  CellLight fine;
  fine.by_replicate.resize(2);
  for (int b = 0; b < 48 * 48; ++b) {
    fine.measure.push_back(1.0);
    fine.target.push_back(b % 48);
    for (auto& row : fine.by_replicate) row.push_back(b / 48);
  }
  const CellLight c = merged(fine, 48, 12);
  ASSERT_EQ(c.measure.size(), 144u);
  EXPECT_EQ(c.measure[5], 16.0);
  EXPECT_EQ(c.target[13], 4.0 * (4 + 5 + 6 + 7));
  EXPECT_EQ(c.by_replicate[1][13], 4.0 * (4 + 5 + 6 + 7));
  EXPECT_EQ(merged(fine, 1, 24).measure.size(), 24u);
}

// Half of the light where none should be, and none where half should be.
TEST(AbsoluteError, IsThatOfItsDefinition) {
  const CellLight c{{1, 1, 1}, {2, 2, 0}, {{3, 0, 3}, {3, 0, 3}}};
  EXPECT_DOUBLE_EQ(absolute_error(c).value, 1.0);
  EXPECT_EQ(absolute_error(c).noise, 0.0);
}

TEST(Unevenness, IsStandardDeviationOverMean) {
  const CellLight c{{1, 1, 0, 1}, {1, 1, 1, 1}, {{1, 2, 99, 3}, {1, 2, 99, 3}}};
  EXPECT_DOUBLE_EQ(unevenness(c).raw, std::sqrt(2.0 / 3.0) / 2.0);
  EXPECT_DOUBLE_EQ(unevenness(c).without_noise, unevenness(c).raw);
}

// Of noise alone nothing is left on average: the square that is left is below a third of what noise makes.
TEST(UnevennessStatistical, NoiseIsTakenOut) {
  CellLight c = made(0.0, 0.05, 3);
  c.measure.assign(kCells, 1.0);
  for (auto& row : c.by_replicate) {
    for (std::size_t i = 0; i < kCells; ++i) row[i] /= c.target[i];
  }
  EXPECT_NEAR(unevenness(c).raw, 0.05, 0.01);
  EXPECT_LT(unevenness(c).without_noise, 0.03);
}

}  // namespace
}  // namespace bench
