// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/spectral_weighting.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr int kCount = 16;

TentBins small_window() { return TentBins::square(Frame(), 0.1, kCount); }

Eigen::VectorXd random_flux(std::uint64_t seed) {
  Rng rng(seed, 0);
  Eigen::VectorXd flux(kCount * kCount);
  for (double& f : flux) f = rng.uniform();
  return flux;
}

/// What residuals count: squares over measure.
double cost(const TentBins& bins, const Eigen::VectorXd& flux) {
  double sum = 0.0;
  for (std::size_t i = 0; i < bins.size(); ++i) {
    sum += flux[static_cast<Eigen::Index>(i)] * flux[static_cast<Eigen::Index>(i)] / bins.measure()[i];
  }
  return sum;
}

/// Light of one bin moved by `cells` to the right.
Eigen::VectorXd moved(int cells) {
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(Eigen::Index{kCount} * kCount);
  flux[8 * kCount + 2] = 1.0;
  flux[8 * kCount + 2 + cells] = -1.0;
  return flux;
}

TEST(SpectralWeighting, LightCostsTheMoreTheFartherItHasToGo) {
  const TentBins bins = small_window();
  const SpectralWeighting scale(bins, 1.0);
  double last = 0.0;
  for (const int cells : {1, 2, 4, 8, 12}) {
    const double now = cost(bins, scale.flux(moved(cells)));
    EXPECT_GT(now, 1.1 * last) << cells;
    last = now;
  }
  // Bins alone do not know how far they are apart.
  EXPECT_NEAR(cost(bins, moved(12)) / cost(bins, moved(2)), 1.0, 0.03);
}

TEST(SpectralWeighting, KeepsEvenDensityAndLosesNothing) {
  const TentBins bins = small_window();
  Eigen::VectorXd even(kCount * kCount), checks(kCount * kCount);
  for (int i = 0; i < kCount * kCount; ++i) {
    even[i] = std::sqrt(bins.measure()[static_cast<std::size_t>(i)]);
    checks[i] = ((i % kCount + i / kCount) % 2 == 0 ? 1.0 : -1.0) * even[i];
  }
  const SpectralWeighting scale(bins, 2.0);
  EXPECT_LT((scale.flux(even) - even).norm(), 1e-12 * even.norm());
  const double left = cost(bins, scale.flux(checks)) / cost(bins, checks);
  EXPECT_LT(left, 0.01);
  EXPECT_GT(left, 1e-5);
}

TEST(SpectralWeighting, ManyWavesChangeNothing) {
  const TentBins bins = small_window();
  const Eigen::VectorXd flux = random_flux(1);
  EXPECT_LT((SpectralWeighting(bins, 1e9).flux(flux) - flux).norm(), 1e-9 * flux.norm());
  EXPECT_GT((SpectralWeighting(bins, 8.0).flux(flux) - flux).norm(), 1e-2 * flux.norm());
}

TEST(SpectralWeighting, DerivativesAreThoseOfTheFlux) {
  const TentBins bins = small_window();
  const SpectralWeighting scale(bins, 3.0);
  Evaluation e;
  e.flux = random_flux(1);
  e.jacobian.resize(Eigen::Index{kCount} * kCount, 5);
  for (int k = 0; k < 5; ++k) e.jacobian.col(k) = random_flux(2 + static_cast<std::uint64_t>(k));
  const Evaluation out = scale(e);
  const Eigen::VectorXd step = Eigen::VectorXd::LinSpaced(5, -1.0, 2.0);
  const Eigen::VectorXd there = scale.flux(e.flux + e.jacobian * step);
  EXPECT_LT((out.flux + out.jacobian * step - there).norm(), 1e-12 * there.norm());
}

}  // namespace
}  // namespace lucerna
