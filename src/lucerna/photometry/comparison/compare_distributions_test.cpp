// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/comparison/transport.h"
#include "lucerna/photometry/data/resample.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

IntensityDistribution filled_grid(const std::function<double(double c, double g)>& cd, double c_step = 10.0,
                                  double g_step = 2.0) {
  IntensityDistribution d = uniform_distribution(c_step, g_step);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) d.at(c, g) = cd(radians(d.c_deg[c]), d.gamma_deg[g]);
  }
  return d;
}

IntensityDistribution dirac(std::size_t c, std::size_t g) {
  IntensityDistribution d = uniform_distribution(5.0, 1.0);
  const bool pole = g == 0 || g == 180;
  for (std::size_t i = 0; i < d.c_deg.size(); ++i) {
    if (pole || i == c) d.at(i, g) = 100.0;
  }
  return d;
}

IntensityDistribution spot() {
  return filled_grid(
      [](double c, double g) {
        return 1000.0 * std::exp(-g * g / 200.0) * (1.0 + 0.3 * std::sin(radians(g)) * std::cos(2.0 * c));
      },
      5.0, 1.0);
}

// The design's bar: within 0.1 degree at any angle.
TEST(Wasserstein, TwoDiracsAreAsFarAsTheirAngle) {
  const std::size_t pairs[][4] = {{0, 0, 0, 1},    {0, 0, 0, 90},  {0, 0, 0, 180},  {3, 20, 40, 70},
                                  {0, 89, 36, 91}, {7, 45, 8, 45}, {10, 3, 50, 177}};
  for (const auto& p : pairs) {
    const auto at = [](std::size_t c, std::size_t g) {
      return direction_from_type_c({radians(5.0 * static_cast<double>(c)), radians(static_cast<double>(g))});
    };
    const double angle = degrees(angle_between(at(p[0], p[1]), at(p[2], p[3])));
    EXPECT_NEAR(wasserstein_deg(dirac(p[0], p[1]), dirac(p[2], p[3])), angle, 1e-6);
  }
}

// A point at 10 degrees (the spot's sigma) beside the great circle of the tilt moves 1 - cos(10 deg) = 1.5 %
// less than the tilt, and none moves more.
TEST(Wasserstein, TiltMovesTheLightByItsAngle) {
  for (const double tilt : {0.5, 2.0, 10.0, 60.0}) {
    const double distance = wasserstein_deg(spot(), rotated(spot(), {radians(tilt), 0.0, 0.0}));
    EXPECT_LT(distance, tilt + 0.02);
    EXPECT_GT(distance, tilt * (1.0 - 0.02) - 0.02);
  }
}

// Against all permutations: of equal masses the best matching is the optimum.
TEST(Wasserstein, SimplexFindsTheBestMatching) {
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    Rng rng(3, seed);
    const auto direction = [&] {
      const double z = 2.0 * rng.uniform() - 1.0, phi = 6.28 * rng.uniform(), s = std::sqrt(1.0 - z * z);
      return Direction::from({s * std::cos(phi), s * std::sin(phi), z});
    };
    std::vector<DirectionMass> from(6), to(6);
    for (auto& each : from) each = {direction(), 0.5};
    for (auto& each : to) each = {direction(), 0.5};
    std::vector<std::size_t> order{0, 1, 2, 3, 4, 5};
    double best = 1e9;
    do {
      double cost = 0.0;
      for (std::size_t i = 0; i < 6; ++i)
        cost += 0.5 * angle_between(from[i].direction, to[order[i]].direction);
      best = std::min(best, cost);
    } while (std::next_permutation(order.begin(), order.end()));
    EXPECT_NEAR(transport_cost_rad(from, to), best, 1e-6 * best) << seed;
  }
}

TEST(Wasserstein, UnequalMassesSplit) {
  const Direction x = Direction::from({1.0, 0.0, 0.0}), y = Direction::from({0.0, 1.0, 0.0}), z;
  // 3 at x goes 1 to y, 2 to z: a quarter circle each.
  EXPECT_NEAR(transport_cost_rad({{x, 3.0}}, {{y, 1.0}, {z, 2.0}}), 3.0 * radians(90.0), 1e-8);
  EXPECT_NEAR(transport_cost_rad({{x, 1.0}, {y, 2.0}}, {{y, 1.0}, {x, 2.0}}), radians(90.0), 1e-8);
}

TEST(CompareDistributions, EqualIsEqual) {
  const DistributionComparison same = compare_distributions(spot(), spot());
  EXPECT_EQ(same.relative_rms.mean, 0.0);
  EXPECT_EQ(same.bergen_fit.mean, 100.0);
  EXPECT_EQ(same.flux_ratio.mean, 1.0);
  EXPECT_EQ(same.wasserstein_deg.mean, 0.0);
  EXPECT_EQ(same.overlap.mean, 1.0);
  EXPECT_EQ(same.alignment->tilt_deg.mean, 0.0);
}

TEST(CompareDistributions, ScaleShowsInFluxAndRmsButNotInShape) {
  IntensityDistribution brighter = spot();
  scale(brighter, 1.01);
  const DistributionComparison c = compare_distributions(spot(), brighter);
  EXPECT_NEAR(c.relative_rms.mean, 0.01, 1e-12);
  EXPECT_NEAR(c.bergen_fit.mean, 100.0 * (1.0 - 0.01 / 2.01), 1e-9);
  EXPECT_NEAR(c.flux_ratio.mean, 1.01, 1e-12);
  EXPECT_NEAR(c.peak_ratio.mean, 1.01, 1e-12);
  EXPECT_NEAR(c.wasserstein_deg.mean, 0.0, 1e-9);
  EXPECT_NEAR(c.overlap.mean, 1.0, 1e-12);
}

TEST(CompareDistributions, GridsNeedNotAgree) {
  const IntensityDistribution coarse =
      filled_grid([](double, double g) { return 100.0 - 0.5 * g; }, 30.0, 10.0);
  const IntensityDistribution fine = filled_grid([](double, double g) { return 100.0 - 0.5 * g; }, 7.5, 1.5);
  const DistributionComparison c = compare_distributions(coarse, fine);
  EXPECT_NEAR(c.relative_rms.mean, 0.0, 1e-12);
  EXPECT_NEAR(c.wasserstein_deg.mean, 0.0, 1e-9);
}

IntensityDistribution street_light(double c_step = 5.0, double g_step = 1.0) {
  return filled_grid(
      [](double c, double g) {
        return g < 90.0 ? 100.0 * std::cos(radians(g)) + 400.0 * std::exp(-std::pow((g - 55.0) / 12.0, 2.0)) *
                                                             std::pow(0.5 + 0.5 * std::sin(c + 0.4), 3.0)
                        : 0.0;
      },
      c_step, g_step);
}

TEST(CompareDistributions, AlignmentFindsTiltAndTurn) {
  const IntensityDistribution street = street_light();
  // B = A tilted by 1.5 degrees; to fit, it must go back.
  const DistributionComparison tilted =
      compare_distributions(street, rotated(street, {radians(1.5), 0.0, 0.0}));
  EXPECT_GT(tilted.relative_rms.mean, 0.03);
  EXPECT_NEAR(tilted.alignment->tilt_deg.mean, 1.5, 0.05);
  EXPECT_NEAR(tilted.alignment->tilt_toward_c_deg.mean, 270.0, 3.0);
  EXPECT_LT(tilted.alignment->relative_rms.mean, 0.25 * tilted.relative_rms.mean);
  const DistributionComparison turned =
      compare_distributions(street, rotated(street, {0.0, 0.0, radians(90.0)}));
  EXPECT_NEAR(turned.alignment->turn_deg.mean, -90.0, 0.1);
  EXPECT_LT(turned.alignment->relative_rms.mean, 0.01);
}

// A turned spot of revolution is the same spot: what is found best is chance.
TEST(CompareDistributions, ATurnThatAnyOtherIsAsGoodAsIsNone) {
  const IntensityDistribution round =
      filled_grid([](double, double g) { return 1000.0 * std::exp(-g * g / 200.0); }, 5.0, 1.0);
  IntensityDistribution wider =
      filled_grid([](double, double g) { return 1000.0 * std::exp(-g * g / 300.0); }, 5.0, 1.0);
  const DistributionComparison exact = compare_distributions(round, wider);
  EXPECT_GT(exact.alignment->turn_deg.standard_error, 100.0);
  Rng rng(7, 0);
  const std::vector<double> error(wider.cd.size(), 5.0);
  for (double& cd : wider.cd) cd = std::max(0.0, cd + 10.0 * std::sqrt(3.0) * (rng.uniform() - 0.5));
  const DistributionComparison noisy = compare_distributions(round, wider, {.test_error_cd = error});
  EXPECT_GT(noisy.alignment->turn_deg.standard_error, 100.0);
  const DistributionComparison street = compare_distributions(street_light(), street_light(2.5, 1.0));
  EXPECT_FALSE(street.alignment->turn_deg.standard_error > 10.0);
}

struct NoisyLight {
  IntensityDistribution distribution;
  std::vector<double> error;
};

/// With normal noise of a share of each value.
NoisyLight noisy(const IntensityDistribution& truth, double share, std::uint64_t seed) {
  NoisyLight out{truth, std::vector<double>(truth.cd.size())};
  for (std::size_t i = 0; i < out.error.size(); ++i) {
    Rng rng(seed, i);
    double normal = -6.0;
    for (int k = 0; k < 12; ++k) normal += rng.uniform();
    out.error[i] = share * truth.cd[i];
    out.distribution.cd[i] += out.error[i] * normal;
  }
  return out;
}

TEST(CompareDistributionsStatistical, NoiseFloorIsWhatNoiseGives) {
  const IntensityDistribution truth =
      filled_grid([](double, double g) { return g < 90.0 ? 500.0 * std::cos(radians(g)) : 0.0; }, 15.0, 5.0);
  const NoisyLight test = noisy(truth, 0.02, 11);
  const DistributionComparison c =
      compare_distributions(truth, test.distribution, {.test_error_cd = test.error, .align = false});
  EXPECT_NEAR(c.noise_floor, 0.02, 1e-6);
  EXPECT_NEAR(c.relative_rms.mean / c.noise_floor, 1.0, 0.25);  // 5 sigma for about 400 cells
  EXPECT_FALSE(c.alignment);
}

// Twenty runs: a scatter is known to 16 %, the mean of the stated errors to 6 %. A factor of 1.8 is 3.6
// sigma; errors of half or twice the size fail.
TEST(CompareDistributionsSlow, ErrorsAreTheScatterOfTheFigures) {
  constexpr int kRuns = 20;
  const IntensityDistribution truth = street_light(10.0, 3.0),
                              tilted = rotated(truth, {radians(1.5), 0.0, 0.0});
  const double excess = compare_distributions(truth, tilted, {.align = false}).excess.mean;
  using Figure = std::function<Estimate(const DistributionComparison&)>;
  const std::pair<const char*, Figure> figures[] = {
      {"flux", [](const DistributionComparison& c) { return c.flux_ratio; }},
      {"excess", [](const DistributionComparison& c) { return c.excess; }},
      {"tilt", [](const DistributionComparison& c) { return c.alignment->tilt_deg; }},
      {"toward", [](const DistributionComparison& c) { return c.alignment->tilt_toward_c_deg; }},
      {"turn", [](const DistributionComparison& c) { return c.alignment->turn_deg; }}};
  std::vector<DistributionComparison> runs;
  for (std::uint64_t seed = 1; seed <= kRuns; ++seed) {
    const NoisyLight test = noisy(tilted, 0.02, 100 + seed);
    runs.push_back(compare_distributions(truth, test.distribution, {.test_error_cd = test.error}));
  }
  for (const auto& [name, figure] : figures) {
    std::vector<double> values;
    double stated = 0.0;
    for (const DistributionComparison& c : runs) {
      values.push_back(figure(c).mean);
      stated += figure(c).standard_error / kRuns;
    }
    const Estimate mean = mean_estimate(values);
    const double scatter = mean.standard_error * std::sqrt(1.0 * kRuns);
    EXPECT_GT(stated, scatter / 1.8) << name << ' ' << stated << ' ' << scatter;
    EXPECT_LT(stated, scatter * 1.8) << name << ' ' << stated << ' ' << scatter;
    if (name == std::string_view("excess")) {
      EXPECT_NEAR(mean.mean, excess, 4.0 * mean.standard_error);
    }
  }
}

// A trace knows its flux better than the sum of independent values would be known.
TEST(CompareDistributions, AFluxThatIsKnownBetterHasThatError) {
  const IntensityDistribution light = spot();
  const NoisyLight test = noisy(light, 0.2, 3);
  CompareOptions options;
  options.test_error_cd = test.error;
  options.align = false;
  const double of_values = compare_distributions(light, test.distribution, options).flux_ratio.standard_error;
  options.test_flux_error = 0.0;
  const DistributionComparison known = compare_distributions(light, test.distribution, options);
  EXPECT_LT(known.flux_ratio.standard_error, 1e-9);
  EXPECT_GT(known.wasserstein_deg.standard_error, 0.0);
  options.test_flux_error = 3.0 * of_values * total_flux(light);
  const double stated = compare_distributions(light, test.distribution, options).flux_ratio.standard_error;
  EXPECT_GT(stated, 1.5 * of_values);  // of eight copies: known to a quarter
  EXPECT_LT(stated, 6.0 * of_values);
}

// Files that state no errors: figures have none either.
TEST(CompareDistributions, UnknownErrorsAreNotANumber) {
  const DistributionComparison c = compare_distributions(street_light(), spot());
  for (const Estimate& e : {c.relative_rms, c.excess, c.flux_ratio, c.wasserstein_deg, c.alignment->tilt_deg})
    EXPECT_TRUE(std::isnan(e.standard_error));
  EXPECT_EQ(c.excess.mean, c.relative_rms.mean);
}

TEST(CompareDistributions, RefusesWhatCannotBeCompared) {
  IntensityDistribution watts = spot();
  watts.unit = FluxUnit::watt;
  EXPECT_THROW(compare_distributions(spot(), watts), InputError);
  EXPECT_THROW(compare_distributions(spot(), uniform_distribution(90.0, 10.0)), InputError);
}

}  // namespace
}  // namespace lucerna
