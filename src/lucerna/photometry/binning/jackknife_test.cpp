// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/jackknife.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr std::size_t kSampleReplicates = 16;

double normal(Rng& rng) {
  double sum = -6.0;
  for (int k = 0; k < 12; ++k) sum += rng.uniform();
  return sum;
}

/// A mean of replicates that scatter by `spread` about `mean`.
Jackknife noisy(double mean, double spread, Rng& rng) {
  double part[kSampleReplicates], sum = 0.0;
  for (double& p : part) sum += p = mean + spread * normal(rng);
  std::vector<double> values{sum / kSampleReplicates};
  for (const double p : part) values.push_back((sum - p) / (kSampleReplicates - 1.0));
  return Jackknife(std::move(values));
}

TEST(Jackknife, OfAMeanIsTheStandardErrorOfTheMean) {
  const Jackknife j({3.0, 14.0 / 4, 13.0 / 4, 12.0 / 4, 11.0 / 4, 10.0 / 4});  // of 1, 2, 3, 4, 5
  EXPECT_DOUBLE_EQ(j.estimate().mean, 3.0);
  EXPECT_NEAR(j.estimate().standard_error, std::sqrt(2.5 / 5.0), 1e-12);
  EXPECT_TRUE(std::isnan(Jackknife(std::vector<double>{3.0}).estimate().standard_error));
}

TEST(Jackknife, DrawsScatterByTheErrorAndComeBack) {
  Rng rng(6, 0);
  const Jackknife x = noisy(10.0, 1.0, rng), draws = x.draws();
  EXPECT_EQ(x.all(), draws.all());
  const Jackknife back = Jackknife::from_draws({draws.values().begin(), draws.values().end()});
  EXPECT_NEAR(back.estimate().standard_error, x.estimate().standard_error, 1e-12);
  // A step beside the value: no replicate's absence crosses it, the noise does.
  const double step = x.all() + 0.9 * x.estimate().standard_error;
  const auto jump = [step](double v) { return v > step ? 1.0 : 0.0; };
  EXPECT_EQ(x.map(jump).estimate().standard_error, 0.0);
  const Jackknife jumps = draws.map(jump);
  EXPECT_GT(Jackknife::from_draws({jumps.values().begin(), jumps.values().end()}).estimate().standard_error,
            0.1);
}

TEST(Jackknife, RatiosCarryTheirCorrelation) {
  Rng rng(5, 0);
  const Jackknife x = noisy(10.0, 1.0, rng);
  const Jackknife twice = x.map([](double v) { return 2.0 * v; });
  EXPECT_NEAR(ratio(twice, x).estimate().mean, 2.0, 1e-12);
  EXPECT_NEAR(ratio(twice, x).estimate().standard_error, 0.0, 1e-12);
}

// Of twenty values the largest: with real differences as large as the noise, where the plain largest is too
// large by half of it; and far apart, where there is nothing to choose.
TEST(JackknifeStatistical, TheLargestOfManyIsNotTooLarge) {
  constexpr int kRuns = 400;
  constexpr double kError = 1.0, kSpread = kError * 4.0;  // of the mean of 16
  double plain = 0.0, corrected = 0.0;
  int inside = 0;
  for (int run = 0; run < kRuns; ++run) {
    Rng rng(17, static_cast<std::uint64_t>(run));
    std::vector<Jackknife> candidates;
    double truth = -1e9;
    for (int k = 0; k < 20; ++k) {
      const double mean = 100.0 + kError * normal(rng);
      truth = std::max(truth, mean);
      candidates.push_back(noisy(mean, kSpread, rng));
    }
    const LargestFigure max = largest(candidates);
    plain += (candidates[max.index].all() - truth) / kRuns;
    corrected += (max.estimate.mean - truth) / kRuns;
    if (std::abs(max.estimate.mean - truth) <= kIntervalErrors * max.estimate.standard_error) ++inside;
  }
  EXPECT_GT(plain, 0.5 * kError);
  EXPECT_LT(std::abs(corrected), 0.3 * kError);
  EXPECT_GT(inside, 0.9 * kRuns);
}

// The mean of seventeen equal values may differ from them by rounding.
TEST(Jackknife, EqualValuesTakeTheErrorThatIsGiven) {
  for (const double value : {0.0, 1.0 / 3.0, 163'400.1}) {
    const Jackknife level(std::vector<double>(17, value));
    EXPECT_NEAR(level.with_error(0.25).estimate().standard_error, 0.25, 1e-9) << value;
  }
}

TEST(Jackknife, WithNothingToChooseTheLargestIsItself) {
  Rng rng(5, 1);
  const std::vector<Jackknife> candidates{noisy(10.0, 0.1, rng), noisy(20.0, 0.1, rng), noisy(5.0, 0.1, rng)};
  const LargestFigure max = largest(candidates);
  EXPECT_EQ(max.index, 1u);
  EXPECT_NEAR(max.estimate.mean, candidates[1].all(), 1e-9);
  EXPECT_NEAR(max.estimate.standard_error, candidates[1].estimate().standard_error, 1e-9);
}

// Of a mean the pseudo-values are the replicates.
TEST(Jackknife, HalvesSayWhatTheirOwnReplicatesDo) {
  const std::vector<double> own{3.0, 10.0, 5.0, 14.0, 7.0, 12.0};  // numbered from 1
  std::vector<double> values{51.0 / 6.0};
  for (const double v : own) values.push_back((51.0 - v) / 5.0);
  const Estimate odd = half_estimate(values, true), even = half_estimate(values, false);
  EXPECT_NEAR(odd.mean, 5.0, 1e-12);
  EXPECT_NEAR(odd.standard_error, std::sqrt(4.0 / 3.0), 1e-12);
  EXPECT_NEAR(even.mean, 12.0, 1e-12);
  EXPECT_NEAR(even.standard_error, std::sqrt(4.0 / 3.0), 1e-12);
}

}  // namespace
}  // namespace lucerna
