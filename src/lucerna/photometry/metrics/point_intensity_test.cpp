// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/point_intensity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numbers>
#include <vector>

#include "lucerna/random.h"

namespace lucerna {
namespace {

Direction toward(double c_deg, double gamma_deg) {
  return direction_from_type_c({radians(c_deg), radians(gamma_deg)});
}

/// By Box and Muller.
double normal_deviate(Rng& rng) {
  return std::sqrt(-2.0 * std::log(1.0 - rng.uniform())) * std::cos(2.0 * std::numbers::pi * rng.uniform());
}

/// A Gaussian lobe of 1000 cd with noise of 20 % over the root of the samples, other noise for each seed and
/// direction, or the same for all directions.
PointIntensity noisy_lobe(const Direction& centre, double sigma_deg, std::uint64_t stream = 0,
                          bool same_noise = false) {
  return [=](const Direction& d, std::uint64_t samples, std::uint64_t seed) {
    const double t = degrees(angle_between(d, centre)) / sigma_deg;
    const double cd = 1000.0 * std::exp(-0.5 * t * t);
    std::uint64_t bits = 0;
    const double key = same_noise ? 0.0 : d.x() + 3.0 * d.y();
    std::memcpy(&bits, &key, sizeof bits);
    Rng rng(detail::mix_bits(bits + stream), seed);
    const double error = 0.2 * cd / std::sqrt(static_cast<double>(samples));
    return Estimate{cd + error * normal_deviate(rng), error};
  };
}

TEST(PointIntensity, SamplesGrowUntilItIsPrecise) {
  const Estimate e = precise_intensity(noisy_lobe(toward(0.0, 20.0), 3.0), toward(0.0, 20.0));
  EXPECT_LE(e.standard_error, 3.1);
  EXPECT_GT(e.standard_error, 1.0);
}

// The start is half a sigma away, 12 % too dark.
TEST(PointIntensity, FindsTheTopOfALobe) {
  const Direction centre = toward(30.0, 20.0);
  const std::vector<Direction> starts{toward(33.0, 21.0), toward(200.0, 60.0)};
  const PointPeak peak = brightest_point(noisy_lobe(centre, 3.0), starts, 1.5);
  EXPECT_LT(degrees(angle_between(peak.direction, centre)), 0.6);
  EXPECT_NEAR(peak.cd.mean, 1000.0, 20.0);
}

/// A flat top of 11 x 11 ripples 1.5 degrees apart, of random heights within 3 % of 1000 cd, and the highest.
struct Ripples {
  explicit Ripples(std::uint64_t seed) {
    Rng rng(seed, 5);
    for (double& h : height) h = 1000.0 * (1.0 + 0.03 * (2.0 * rng.uniform() - 1.0));
  }
  double at(const Direction& d) const {
    const double x = degrees(d.x()) / 1.5, y = degrees(d.y()) / 1.5;
    double cd = 960.0;
    for (int i = 0; i < kSide * kSide; ++i) {
      const double dx = x - i % kSide + kSide / 2, dy = y - i / kSide + kSide / 2;
      cd = std::max(cd, height[i] - 100.0 * (dx * dx + dy * dy));
    }
    return cd;
  }
  double highest() const { return *std::max_element(std::begin(height), std::end(height)); }
  static constexpr int kSide = 11;
  double height[kSide * kSide];
};

// Four starts alone find a ripple within one per cent of the highest in 26 of 40 tops; what is looked at
// about the best of them finds it in more. How heights are spread is stated.
TEST(PointIntensityStatistical, FindsAHighRippleAndSaysHowHighOthersMayBe) {
  int held = 0, within = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const Ripples top(seed);
    const PointIntensity noisy = [&](const Direction& d, std::uint64_t samples, std::uint64_t stream) {
      const Estimate noise = noisy_lobe(toward(0.0, 0.0), 1e3, seed)(d, samples, stream);
      return Estimate{top.at(d) + 0.2 * (noise.mean - 1000.0), 0.2 * noise.standard_error};
    };
    std::vector<Direction> starts;
    Rng rng(seed, 6);
    for (int i = 0; i < 4; ++i)
      starts.push_back(toward(360.0 * rng.uniform(), 7.0 * std::sqrt(rng.uniform())));
    const PointPeak peak = brightest_point(noisy, starts, 0.75);
    const double gap = top.highest() - peak.cd.mean;
    const double error = std::hypot(peak.cd.standard_error, peak.search_error_cd);
    held += std::abs(gap) <= 3.0 * error + 3.0 ? 1 : 0;
    within += std::abs(gap) <= 10.0 ? 1 : 0;
  }
  EXPECT_GE(held, 36);
  EXPECT_GE(within, 36);
}

// A tip of 1 % that is narrower than a search's steps, and one of eight starts on it. The starts are first
// looked at with noise of 0.6 %, at which the tip is the brightest of them in two of three cases. Of 100
// cases 90 or more find it, as do all but some hundredths by 4096 samples; two thirds do with a chance of
// 1e-7.
TEST(PointIntensityStatistical, DoesNotLoseTheBestStartToNoise) {
  int found = 0;
  for (std::uint64_t stream = 0; stream < 100; ++stream) {
    const Direction tip = toward(45.0 * static_cast<double>(stream % 8), 3.0);
    const PointIntensity noisy = [&](const Direction& d, std::uint64_t samples, std::uint64_t seed) {
      const Estimate noise = noisy_lobe(toward(0.0, 0.0), 1e3, stream)(d, samples, seed);
      return Estimate{noise.mean - (angle_between(d, tip) < radians(0.05) ? 0.0 : 10.0),
                      noise.standard_error};
    };
    std::vector<Direction> starts;
    for (int i = 0; i < 8; ++i) starts.push_back(toward(45.0 * i, 3.0));
    const PointPeak peak = brightest_point(noisy, starts, 0.75);
    found += angle_between(peak.direction, tip) < radians(0.05) ? 1 : 0;
  }
  EXPECT_GE(found, 90);
}

TEST(PointIntensity, SaysNothingWhereTheEndsAreNotThere) {
  const PointIntensity lobe = noisy_lobe(toward(0.0, 0.0), 3.0);
  const auto line = [](double angle) { return toward(angle < 0.0 ? 180.0 : 0.0, std::abs(angle)); };
  EXPECT_FALSE(exact_arc_deg(lobe, line, {-4.0, 4.0}, {0.5, 0.1}, {1500.0, 0.0}));
  EXPECT_FALSE(exact_arc_deg(lobe, line, {-1.0, 1.0}, {0.5, 0.1}, {500.0, 0.0}));
}

// A mean of six directions of 256 samples each: its noise decides.
TEST(PointIntensity, SaysNothingWhereTheLightIsNotWellKnown) {
  const PointIntensity lobe = noisy_lobe(toward(0.0, 0.0), 3.0);
  const auto line = [](double angle) { return toward(angle < 0.0 ? 180.0 : 0.0, std::abs(angle)); };
  const CircleArc near{-3.5, 3.5};
  double variance = 0.0;
  for (int i = 0; i < 6; ++i) {
    const double error = lobe(line(3.5), 256, 1).standard_error / 6.0;
    variance += error * error;
  }
  const double noise = std::sqrt(variance) / 500.0;
  EXPECT_TRUE(exact_arc_deg(lobe, line, near, {0.5, 0.1, 1.5 * noise}, {500.0, 0.0}));
  EXPECT_FALSE(exact_arc_deg(lobe, line, near, {0.5, 0.1, 0.5 * noise}, {500.0, 0.0}));
}

/// How many of 100 arcs of a Gaussian lobe of `sigma` degrees hold the truth within two of their errors, and
/// the mean of these. `near` is off by up to 0.15 degrees and `shift_deg`.
struct Held {
  int arcs = 0;
  double mean_error = 0.0;
};
Held held_arcs(double sigma, double window_deg, double shift_deg, double threshold_cd = 500.0) {
  const double truth = 2.0 * sigma * std::sqrt(2.0 * std::log(1000.0 / threshold_cd));
  const auto line = [](double angle) { return toward(angle < 0.0 ? 180.0 : 0.0, std::abs(angle)); };
  Held out;
  for (std::uint64_t stream = 0; stream < 100; ++stream) {
    const double off = 0.01 * static_cast<double>(stream % 30) - 0.15 + shift_deg;
    const CircleArc near{-0.5 * truth + off, 0.5 * truth + off};
    const auto arc = exact_arc_deg(noisy_lobe(toward(0.0, 0.0), sigma, stream), line, near,
                                   {window_deg, 0.2 * window_deg}, {threshold_cd, 0.0});
    if (!arc) continue;
    out.arcs += std::abs(arc->mean - truth) <= 2.0 * arc->standard_error ? 1 : 0;
    out.mean_error += arc->standard_error / 100.0;
  }
  return out;
}

// 100 arcs at 95 %: 85 or fewer hold with a chance of 1e-4 if the errors are right; with half of the errors
// (67 % hold), 85 or more with one of 1e-4.
TEST(PointIntensityStatistical, ArcsHoldTheTruthWithinTheirErrors) {
  const Held near = held_arcs(3.0, 0.5, 0.0);
  EXPECT_GE(near.arcs, 85);
  EXPECT_LT(near.mean_error, 0.02);
}

// Means over a fifth of such a window are 0.05 degrees off, four of their errors.
TEST(PointIntensityStatistical, ArcsOfBentFlanksHoldTheTruth) {
  const Held wide = held_arcs(3.0, 6.0, 0.0);
  EXPECT_GE(wide.arcs, 85);
  EXPECT_LT(wide.mean_error, 0.03);
}

// At a thousandth of the peak a step of a fifth of the window spans a factor of twenty.
TEST(PointIntensityStatistical, ArcsFarDownATailHoldTheTruth) {
  const Held tail = held_arcs(1.0, 4.0, 0.0, 1.0);
  EXPECT_GE(tail.arcs, 85);
  EXPECT_LT(tail.mean_error, 0.02);
}

// One set of random numbers is too bright in all directions, or too dark. Mean squares of 400 scatter by 7 %:
// above 1.4 with a chance of 1e-8. With the same numbers at both ends it is 2.
TEST(PointIntensityStatistical, EndsOfAnArcDoNotShareTheirNoise) {
  const auto line = [](double angle) { return toward(angle < 0.0 ? 180.0 : 0.0, std::abs(angle)); };
  const double truth = 6.0 * std::sqrt(2.0 * std::log(2.0));
  double squares = 0.0;
  for (std::uint64_t stream = 1; stream <= 400; ++stream) {
    const auto arc = exact_arc_deg(noisy_lobe(toward(0.0, 0.0), 3.0, stream, true), line,
                                   {-0.5 * truth, 0.5 * truth}, {0.5, 0.1}, {500.0, 0.0});
    ASSERT_TRUE(arc);
    const double errors = (arc->mean - truth) / arc->standard_error;
    squares += errors * errors / 400.0;
  }
  EXPECT_LT(squares, 1.4);
  EXPECT_GT(squares, 0.6);
}

// A kernel moves the arc of a lopsided lobe by more than the window.
TEST(PointIntensityStatistical, ArcsAreFoundInwardOfTheWindow) {
  EXPECT_GE(held_arcs(3.0, 0.5, 0.8).arcs, 85);
}

}  // namespace
}  // namespace lucerna
