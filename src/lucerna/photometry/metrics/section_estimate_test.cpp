// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/metrics/section_estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Intensity of a light that is round about the axis, by gamma in degrees.
using ByGamma = std::function<double(double gamma_deg)>;

/// Counted in cells of 5 x 0.5 degrees, each with so much noise of its flux.
CountedSphere noisy_sphere(const ByGamma& cd, double noise, std::uint64_t seed) {
  constexpr std::size_t kPlanes = 72, kGammas = 361, kParts = 16;
  const double dc = 2.0 * std::numbers::pi / kPlanes, dg = std::numbers::pi / (kGammas - 1);
  JackknifedFlux counted(kPlanes * kGammas, kParts);
  for (std::size_t cell = 0; cell < counted.cells(); ++cell) {
    const double gamma = dg * static_cast<double>(cell % kGammas);
    const double low = std::max(0.0, gamma - 0.5 * dg), high = std::min(std::numbers::pi, gamma + 0.5 * dg);
    const double flux = dc * (std::cos(low) - std::cos(high)) * cd(degrees(gamma)) / kParts;
    double part[kParts], sum = 0.0;
    for (std::size_t r = 0; r < kParts; ++r) {
      Rng rng(seed, cell * kParts + r);
      // Of variance 1.
      const double even = std::sqrt(12.0) * (rng.uniform() - 0.5);
      part[r] = flux * (1.0 + noise * std::sqrt(kParts) * even);
      sum += part[r];
    }
    const auto row = counted.row(cell);
    row[0] = sum;
    for (std::size_t r = 0; r < kParts; ++r) row[r + 1] = (sum - part[r]) * kParts / (kParts - 1.0);
  }
  return CountedSphere(kPlanes, kGammas, FluxUnit::lumen, counted);
}

struct Arcs {
  int found = 0, held = 0;
  double error_deg = 0.0;
};

/// Arcs at 500 +- `threshold_error` cd of 50 noisy spheres, and how many intervals of 95 % hold `truth_deg`.
Arcs arcs(const ByGamma& cd, double noise, double threshold_error, double truth_deg) {
  Arcs out;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    const CountedSphere sphere = noisy_sphere(cd, noise, seed);
    Section section(sphere, 0.0, 2.0, 1.0);
    Rng rng(seed, 1);
    const double off = threshold_error * std::sqrt(12.0) * (rng.uniform() - 0.5);
    const auto arc = section.arc_deg({500.0 + off, threshold_error});
    if (!arc) continue;
    ++out.found;
    out.held += std::abs(arc->mean - truth_deg) <= kIntervalErrors * arc->standard_error ? 1 : 0;
    out.error_deg += arc->standard_error;
  }
  out.error_deg /= out.found;
  return out;
}

// A flank of 50 cd a degree.
double steep(double gamma) { return std::clamp(1000.0 - 50.0 * (gamma - 10.0), 0.0, 1000.0); }

// 50 intervals of 95 %: 40 or fewer hold with a chance of 1e-4. Noise over slope is 0.3 degrees.
TEST(SectionEstimateStatistical, SteepFlanksHoldTheTruth) {
  const Arcs found = arcs(steep, 0.05, 5.0, 40.0);
  EXPECT_EQ(found.found, 50);
  EXPECT_GE(found.held, 41);
  EXPECT_LT(found.error_deg, 0.5);
}

// 2 cd a degree along the threshold from 15 to 35 degrees, and a step at either end of that.
double level(double gamma) {
  if (gamma < 15.0) return 1000.0;
  return gamma < 35.0 ? 500.0 - 2.0 * (gamma - 25.0) : 0.0;
}

// Where the light runs level, noise moves an end by as much as the level stretch is long: over the slope of
// any one place it would be stated at a tenth of that.
TEST(SectionEstimateStatistical, LevelLightHasTheErrorOfTheWholeStretch) {
  const Arcs found = arcs(level, 0.05, 5.0, 50.0);
  EXPECT_GE(found.held, found.found - 9);
  EXPECT_TRUE(found.found < 25 || found.error_deg > 3.0) << found.found << ' ' << found.error_deg;
}

// A ring besides the beam: of two equally wide dark stretches either may be the widest, which moves both ends
// by far and the size by little.
double with_ring(double gamma) {
  return steep(gamma) + 1000.0 * std::exp(-std::pow((gamma - 100.0) / 8.0, 2.0));
}

TEST(SectionEstimateStatistical, AnotherDarkStretchOfTheSameWidthIsNoError) {
  // From the ring's outer edge through the beam to its other edge: all but the stretch about gamma 180.
  const double edge = 100.0 + 8.0 * std::sqrt(std::log(2.0));
  const Arcs found = arcs(with_ring, 0.05, 5.0, 2.0 * edge);
  EXPECT_EQ(found.found, 50);
  EXPECT_GE(found.held, 41);
  EXPECT_LT(found.error_deg, 0.6);
}

// A cap about gamma 180 leaves two dark stretches of one width.
TEST(SectionEstimate, TwoStretchesThatNoiseMayOrderAreTwoPlaces) {
  const auto with_cap = [](double gamma) {
    return steep(gamma) + 50.0 * std::clamp(gamma - 150.0, 0.0, 20.0);
  };
  const CountedSphere sphere = noisy_sphere(with_cap, 0.05, 1);
  const auto places = Section(sphere, 0.0, 2.0, 1.0).places({500.0, 5.0});
  ASSERT_EQ(places.size(), 2U);
  for (const auto& p : places) EXPECT_NEAR(p.arc.to_deg - p.arc.from_deg, 220.0, 2.0);
  EXPECT_GT(std::abs(std::remainder(places[0].arc.from_deg - places[1].arc.from_deg, 360.0)), 100.0);
}

TEST(SectionEstimate, AStretchThatIsWiderForCertainIsOnePlace) {
  for (const ByGamma& cd : {ByGamma(steep), ByGamma(with_ring)}) {
    const CountedSphere sphere = noisy_sphere(cd, 0.05, 1);
    EXPECT_EQ(Section(sphere, 0.0, 2.0, 1.0).places({500.0, 5.0}).size(), 1U);
  }
}

TEST(SectionEstimate, SaysNothingWhereTheThresholdIsNotReached) {
  const CountedSphere sphere = noisy_sphere(steep, 0.01, 1);
  Section section(sphere, 0.0, 2.0, 1.0);
  EXPECT_FALSE(section.arc_deg({1500.0, 1.0}));
  EXPECT_FALSE(section.arc_deg({0.0, 0.0}));
  EXPECT_TRUE(section.places({1500.0, 1.0}).empty());
  EXPECT_TRUE(section.arc_deg({500.0, 1.0}));
}

}  // namespace
}  // namespace lucerna
