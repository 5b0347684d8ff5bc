// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/tent_bins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "lucerna/random.h"

namespace lucerna {
namespace {

double sum(const std::vector<double>& v) { return std::accumulate(v.begin(), v.end(), 0.0); }

double weight_of(const TentBins::Deposit& d) {
  double w = 0.0;
  for (int k = 0; k < d.n; ++k) w += d.weight[static_cast<std::size_t>(k)];
  return w;
}

/// Two metres below the lamp, facing it.
Frame floor_below() { return {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -2000}}; }

TEST(TentBins, MeasuresAreTheWindows) {
  // The fading cells beyond the outermost centres keep half of their tents' integral inside the window.
  EXPECT_NEAR(sum(TentBins::plane(floor_below(), 500, 300, 50).measure()), 1000.0 * 600.0, 1e-3 * 600e3);
  const double zone = sum(TentBins::zone(Frame(), 1.0, 40, 12).measure());
  const double cap = 2.0 * std::numbers::pi * (1.0 + std::cos(1.0));
  EXPECT_LT(zone, cap);
  EXPECT_GT(zone, 0.95 * cap);
}

// Light that is uneven around a tilted axis, summed direction by direction.
TEST(TentBins, FluxOfRingsIsTheIntegralOfTheIntensity) {
  const Frame tilted{Vec3{0.8, 0, -0.6}, Vec3{0, 1, 0}, Vec3{0.6, 0, 0.8}, Vec3{}};
  const TentBins bins = TentBins::rings(tilted, 1.2, 12);
  const auto intensity = [](const Direction& d) { return std::exp(3.0 * d.x() + d.y()); };
  std::vector<double> expected(bins.size(), 0.0);
  constexpr int kGammas = 1500, kTurns = 97;
  const double step = std::numbers::pi / kGammas, turn = 2.0 * std::numbers::pi / kTurns;
  TentBins::Deposit d;
  for (int g = 0; g < kGammas; ++g) {
    for (int c = 0; c < kTurns; ++c) {
      const double gamma = (g + 0.5) * step, a = c * turn, s = std::sin(gamma);
      const Direction to =
          tilted.direction(Direction::from({s * std::cos(a), s * std::sin(a), std::cos(gamma)}));
      bins.deposit({}, to.vec(), d);
      for (std::size_t k = 0; k < static_cast<std::size_t>(d.n); ++k)
        expected[static_cast<std::size_t>(d.bin[k])] += d.weight[k] * intensity(to) * s * step * turn;
    }
  }
  const std::vector<double> found = bins.flux_of(intensity);
  for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-3 * expected[i]) << i;
}

TEST(TentBins, PlanesTakeLightWhereItFalls) {
  const TentBins bins = TentBins::plane(floor_below(), 500, 300, 10);
  TentBins::Deposit d;
  // From (0, 0, 0) to (250, 90, -2000): cells of 100 x 60 mm, the centre of column 7 and row 6.
  const Vec3 target{250, 90, -2000};
  bins.deposit({}, target / length(target), d);
  double at_centre = 0.0;
  for (int k = 0; k < d.n; ++k) {
    if (d.bin[static_cast<std::size_t>(k)] == 6 * 10 + 7) at_centre += d.weight[static_cast<std::size_t>(k)];
  }
  EXPECT_NEAR(at_centre, 1.0, 1e-12);
  bins.deposit({0, 0, 0}, {0, 0, 1}, d);  // away from the plane
  EXPECT_EQ(d.n, 0);
  bins.deposit({0, 0, -2500}, {0, 0, 1}, d);  // on its back
  EXPECT_EQ(d.n, 0);
}

TEST(TentBins, EveryRayInsideAZoneCountsOnceAndNoneOutside) {
  const double gamma_min = 1.1;
  const TentBins bins = TentBins::zone(Frame(), gamma_min, 20, 12);
  const double cell = (std::numbers::pi - gamma_min) / 21;
  TentBins::Deposit d;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    Rng rng(7, i);
    const double gamma = std::numbers::pi * rng.uniform(), c = 2.0 * std::numbers::pi * rng.uniform();
    const Vec3 ray{std::sin(gamma) * std::cos(c), std::sin(gamma) * std::sin(c), std::cos(gamma)};
    bins.deposit({}, ray, d);
    if (gamma < gamma_min) {
      EXPECT_EQ(d.n, 0);
    } else if (gamma > gamma_min + cell && gamma < std::numbers::pi - cell) {
      EXPECT_NEAR(weight_of(d), 1.0, 1e-12);
    } else {
      EXPECT_LE(weight_of(d), 1.0 + 1e-12);
    }
  }
}

TEST(TentBins, FluxOnAPlaneIsTheIntegralOfItsDensity) {
  const TentBins bins = TentBins::plane(floor_below(), 400, 400, 32);
  const auto flux = bins.flux_on([](double x, double y) { return std::exp(-(x * x + y * y) / 2e4); });
  EXPECT_NEAR(sum(flux), std::numbers::pi * 2e4, 1e-3 * std::numbers::pi * 2e4);
}

}  // namespace
}  // namespace lucerna
