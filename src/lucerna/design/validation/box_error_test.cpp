// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/box_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

TargetRectangle downwards(double half) {
  return {Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), false, -half, half, -half, half};
}

/// One replicate whose flux is the target's with a factor by box.
template <class Factor>
BoxSums changed(const std::vector<double>& target, const Factor& factor) {
  BoxSums sums;
  sums.flux = target;
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    sums.flux[b] *= factor(b % kErrorBoxes, b / kErrorBoxes);
  }
  sums.emitted = sums.out_reflected = std::accumulate(sums.flux.begin(), sums.flux.end(), 0.0);
  sums.rays = 1;
  return sums;
}

std::vector<double> uniform_target(const ErrorBoxes& boxes) {
  auto flux = boxes.flux_of([](const Direction& d) { return std::max(0.0, -d.z()); }, 0.1);
  for (std::size_t b = ErrorBoxes::kInside; b < flux.size(); ++b) flux[b] = 0.0;
  return flux;
}

TEST(BoxError, RipplesOfOneBoxAreSeenAtTheirScaleAndNotBelowIt) {
  const ErrorBoxes boxes(downwards(0.2));
  const auto target = uniform_target(boxes);
  const auto ripple = [&](std::size_t period) {
    return changed(target, [=](std::size_t u, std::size_t) { return u / period % 2 == 0 ? 1.1 : 0.9; });
  };
  const DesignError fine = box_error(boxes, target, std::vector{ripple(1)}, TargetMode::shape);
  EXPECT_NEAR(fine.c48.excess, 0.1, 0.001);
  EXPECT_NEAR(fine.c24.excess, 0.0, 0.001);
  EXPECT_NEAR(fine.c12.excess, 0.0, 0.001);
  const DesignError medium = box_error(boxes, target, std::vector{ripple(2)}, TargetMode::shape);
  EXPECT_NEAR(medium.c48.excess, 0.1, 0.001);
  EXPECT_NEAR(medium.c24.excess, 0.1, 0.001);
  EXPECT_NEAR(medium.c12.excess, 0.0, 0.001);
  // The best scale is 1 / 1.01: the dark boxes are 0.9 / 1.01.
  EXPECT_NEAR(fine.worst_cell.mean, 1.0 - 0.9 / 1.01, 1e-6);
  EXPECT_EQ(fine.c48.floor, 0.0);
  EXPECT_TRUE(std::isnan(fine.c48.standard_error));  // of one replicate nothing is known
}

TEST(BoxError, ShapeModeTakesTheBestScaleAndAbsoluteModeNone) {
  const ErrorBoxes boxes(downwards(0.3));
  auto target = uniform_target(boxes);
  const BoxSums same = changed(target, [](auto, auto) { return 1.0; });
  for (double& t : target) t *= 0.5 / same.emitted;
  EXPECT_NEAR(box_error(boxes, target, std::vector{same}, TargetMode::shape).c48.value, 0.0, 1e-12);
  EXPECT_NEAR(box_error(boxes, target, std::vector{same}, TargetMode::shape).scale, 0.5, 1e-12);
  EXPECT_NEAR(box_error(boxes, target, std::vector{same}, TargetMode::absolute).c48.value, 1.0, 1e-12);
}

// Fluxes are summed ray by ray, and cell by cell.
TEST(BoxError, RoundingIsNoLightOutside) {
  const ErrorBoxes boxes(downwards(0.3));
  const auto target = uniform_target(boxes);
  for (const double rounding : {1.0 - 3e-13, 1.0 + 3e-13}) {
    BoxSums sums = changed(target, [](auto, auto) { return 1.0; });
    sums.out_reflected *= rounding;
    const DesignError error = box_error(boxes, target, std::vector{sums}, TargetMode::shape);
    EXPECT_EQ(error.outside_share.mean, 0.0);
    EXPECT_EQ(error.outside_direct.mean, 0.0);
  }
}

TEST(BoxError, LightOutsideIsCountedWithItsDirectPart) {
  const ErrorBoxes boxes(downwards(0.3));
  const auto target = uniform_target(boxes);
  BoxSums sums = changed(target, [](auto, auto) { return 1.0; });
  const double inside = sums.emitted;
  const Direction up = Direction::from({0.1, 0.2, 0.9}), aside = Direction::from({0.8, 0.0, -0.6});
  sums.flux[boxes.cell({}, up)] += 0.1 * inside;
  sums.flux[boxes.cell({}, aside)] += 0.3 * inside;
  sums.out_direct = 0.1 * inside;
  sums.out_reflected = 1.3 * inside;
  sums.absorbed = 0.6 * inside;
  sums.emitted = 2.0 * inside;
  const DesignError e = box_error(boxes, target, std::vector{sums}, TargetMode::shape);
  EXPECT_NEAR(e.in_rectangle.mean, 0.5, 1e-12);
  EXPECT_NEAR(e.outside_share.mean, 0.2, 1e-12);
  EXPECT_NEAR(e.outside_direct.mean, 0.05, 1e-12);
  EXPECT_NEAR(e.c48.value, 0.0, 1e-12);
  // Two cells with light, against the target's norm: flux^2 / measure each.
  double norm2 = 0.0;
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) norm2 += target[b] * target[b] / boxes.measure()[b];
  const double expected = std::sqrt((std::pow(0.1 * inside, 2) / boxes.measure()[boxes.cell({}, up)] +
                                     std::pow(0.3 * inside, 2) / boxes.measure()[boxes.cell({}, aside)]) /
                                    norm2);
  EXPECT_NEAR(e.outside.value, expected, 1e-9);
}

/// Replicates of independent rays whose direction cosines have the density 1 + tilt * u / half in the
/// rectangle: exactly a Lambertian emitter's for tilt 0.
std::vector<BoxSums> drawn(const ErrorBoxes& boxes, double half, double tilt, std::uint64_t seed) {
  std::vector<BoxSums> out(16);
  for (std::size_t r = 0; r < out.size(); ++r) {
    Rng rng(seed, r);
    out[r].flux.assign(boxes.size(), 0.0);
    for (int i = 0; i < 40000; ++i) {
      double u = 2.0 * rng.uniform() - 1.0;
      if (rng.uniform() > 0.5 * (1.0 + tilt * u)) u = -u;
      const double x = half * u, y = half * (2.0 * rng.uniform() - 1.0);
      out[r].flux[boxes.cell({}, {x, -y, -std::sqrt(1.0 - x * x - y * y)})] += 1.0;
    }
    out[r].emitted = out[r].out_reflected = 40000.0;
    out[r].rays = 40000;
  }
  return out;
}

TEST(BoxErrorStatistical, NoiseIsTakenOutAndItsErrorIsTrue) {
  const double half = 0.3;
  const ErrorBoxes boxes(downwards(half));
  const auto target = uniform_target(boxes);
  int above = 0;
  double sum = 0.0, stated = 0.0;
  constexpr int kRuns = 40;
  for (int run = 0; run < kRuns; ++run) {
    const DesignError e = box_error(boxes, target, drawn(boxes, half, 0.0, 100u + static_cast<unsigned>(run)),
                                    TargetMode::shape);
    // 640 000 rays in 2304 boxes: a floor of 6 %.
    EXPECT_NEAR(e.c48.floor, 0.06, 0.003);
    // The standard error of value^2 - floor^2 that the excess' own was made of.
    const double se = e.c48.standard_error, e2 = e.c48.value * e.c48.value - e.c48.floor * e.c48.floor;
    const double positive = std::max(0.0, e2);
    const double sigma = 0.5 * (se * se + se * std::sqrt(se * se + 16.0 * positive));
    const double expected = 0.06 * 0.06 * std::sqrt(2.0 / 2304.0);
    EXPECT_GT(sigma, 0.8 * expected);  // 16 replicates give it to some ten per cent, and it errs upwards
    EXPECT_LT(sigma, 3.0 * expected);
    sum += e2 / sigma;
    stated += e2 * e2 / (sigma * sigma);
    above += e2 > 4.0 * sigma ? 1 : 0;
  }
  // E / sigma is normal with a deviation of at most 1: its mean over 40 runs within 5 / sqrt(40), its square
  // below 1 + 5 sqrt(2 / 40); false alarm 1e-6. E passes 4 sigma once in 30000 runs.
  EXPECT_LT(std::abs(sum / kRuns), 5.0 / std::sqrt(kRuns));
  EXPECT_LT(stated / kRuns, 1.0 + 5.0 * std::sqrt(2.0 / kRuns));
  EXPECT_GT(stated / kRuns, 0.2);
  EXPECT_LE(above, 1);
}

TEST(BoxErrorStatistical, AWrongSamplerIsFound) {
  const double half = 0.3, tilt = 0.05;
  const ErrorBoxes boxes(downwards(half));
  const auto target = uniform_target(boxes);
  // density 1 + tilt u / half: rms of tilt * u over [-1, 1] is tilt / sqrt(3).
  const double rms = tilt / std::sqrt(3.0);
  for (const unsigned seed : {1u, 2u, 3u}) {
    const DesignError e = box_error(boxes, target, drawn(boxes, half, tilt, seed), TargetMode::shape);
    EXPECT_GT(e.c12.excess, 5.0 * e.c12.standard_error);
    EXPECT_NEAR(e.c12.excess, rms, 5.0 * e.c12.standard_error);
    EXPECT_NEAR(e.c24.excess, rms, 5.0 * e.c24.standard_error);
    EXPECT_NEAR(e.c48.excess, rms, 5.0 * e.c48.standard_error);
  }
}

IntensityDistribution gaussian_beam(double half_width_deg) {
  IntensityDistribution d = uniform_distribution(5.0, 1.0);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      d.at(c, g) = 1000.0 * std::exp(-std::pow(d.gamma_deg[g] / half_width_deg, 2));
    }
  }
  return d;
}

TEST(BoxError, OfTablesIsExactAndTakesTheirStatedErrorsAsTheFloor) {
  const IntensityDistribution a = gaussian_beam(15.0), b = gaussian_beam(15.6);
  EXPECT_LT(box_error({a}, {a}, TargetMode::shape).c48.value, 1e-12);
  const DesignError e = box_error({a}, {b}, TargetMode::shape);
  EXPECT_GT(e.c48.value, 0.01);
  EXPECT_LT(e.c48.value, 0.1);
  std::vector<double> error(b.cd.size());
  for (std::size_t i = 0; i < error.size(); ++i) error[i] = 0.02 * b.cd[i];
  const DesignError noisy = box_error({a}, {b, error}, TargetMode::shape);
  EXPECT_NEAR(noisy.c48.value, e.c48.value, 1e-4);
  EXPECT_GT(noisy.c48.floor, 0.001);
  EXPECT_LT(noisy.c48.floor, 0.02);  // boxes take means over table values
}

// The same noise makes the same error and floor on either side, and says nothing of the test's own light.
TEST(BoxError, ATargetsStatedErrorsAreNotTakenForAnError) {
  const IntensityDistribution a = gaussian_beam(15.0), b = gaussian_beam(15.6);
  IntensityDistribution rough = a;
  std::vector<double> error(a.cd.size());
  for (std::size_t i = 0; i < error.size(); ++i) {
    Rng rng(5, i);
    error[i] = 0.05 * a.cd[i];
    rough.cd[i] += std::sqrt(3.0) * (2.0 * rng.uniform() - 1.0) * error[i];
  }
  for (const TargetMode mode : {TargetMode::shape, TargetMode::absolute}) {
    const DesignError exact = box_error({a}, {b}, mode), believed = box_error({rough}, {b}, mode),
                      known = box_error({rough, error}, {b}, mode),
                      turned = box_error({b}, {rough, error}, mode);
    EXPECT_GT(std::abs(believed.c48.excess - exact.c48.excess), 3.0 * known.c48.standard_error);
    EXPECT_NEAR(known.c48.excess, exact.c48.excess, 3.0 * known.c48.standard_error);
    EXPECT_NEAR(known.c48.floor, turned.c48.floor, 0.2 * turned.c48.floor);
    EXPECT_EQ(known.in_rectangle.mean, believed.in_rectangle.mean);
    EXPECT_TRUE(std::isnan(known.in_rectangle.standard_error));
  }
}

TEST(BoxError, RefusesWhatCannotBeCompared) {
  const IntensityDistribution a = gaussian_beam(15.0);
  IntensityDistribution watts = a, broken = a, dark = a;
  watts.unit = FluxUnit::watt;
  broken.cd[3] = std::nan("");
  for (double& v : dark.cd) v = 0.0;
  EXPECT_THROW(box_error({a}, {watts}, TargetMode::absolute), InputError);
  EXPECT_NO_THROW(box_error({a}, {watts}, TargetMode::shape));
  EXPECT_THROW(box_error({a}, {broken}, TargetMode::shape), InputError);
  EXPECT_THROW(box_error({broken}, {a}, TargetMode::shape), InputError);
  EXPECT_THROW(box_error({a}, {dark}, TargetMode::shape), InputError);
  EXPECT_THROW(box_error({dark}, {a}, TargetMode::shape), InputError);
  const std::vector<double> three(3, 1.0);
  EXPECT_THROW(box_error({a, three}, {a}, TargetMode::shape), InputError);
  EXPECT_THROW(box_error({a}, {a, three}, TargetMode::shape), InputError);
}

}  // namespace
}  // namespace lucerna
