// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/binned_intensity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

using Intensity = std::function<double(double c_deg, double gamma_deg)>;

/// Exact flux per bin, by the midpoint rule on fine parts of each bin.
std::vector<double> binned_flux(const std::vector<double>& c, const std::vector<double>& g,
                                const Intensity& cd) {
  constexpr int kParts = 24;
  const IntensityBins bins = intensity_bins(c, g);
  std::vector<double> flux;
  for (std::size_t ic = 0; ic < c.size(); ++ic) {
    const double c0 = bins.c_edge_deg[ic];
    const double c1 = ic + 1 < c.size() ? bins.c_edge_deg[ic + 1] : bins.c_edge_deg[0] + 360.0;
    for (std::size_t ig = 0; ig < g.size(); ++ig) {
      const double u0 = std::cos(radians(bins.gamma_edge_deg[ig]));
      const double u1 = std::cos(radians(bins.gamma_edge_deg[ig + 1]));
      double sum = 0.0;
      for (int i = 0; i < kParts; ++i) {
        for (int j = 0; j < kParts; ++j) {
          const double gamma = degrees(std::acos(std::clamp(u0 + (u1 - u0) * (j + 0.5) / kParts, -1.0, 1.0)));
          sum += cd(c0 + (c1 - c0) * (i + 0.5) / kParts, gamma);
        }
      }
      flux.push_back(sum / (kParts * kParts) * bins.solid_angle_sr[ic * g.size() + ig]);
    }
  }
  return flux;
}

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(BinnedIntensity, BinsCoverTheSphere) {
  const std::vector<double> c{0.0, 5.0, 100.0, 300.0}, g{0.0, 1.0, 30.0, 170.0, 180.0};
  const IntensityBins bins = intensity_bins(c, g);
  EXPECT_NEAR(sum_of(bins.solid_angle_sr), 4.0 * std::numbers::pi, 1e-12);
  EXPECT_DOUBLE_EQ(bins.c_edge_deg[0], -30.0);
  EXPECT_DOUBLE_EQ(bins.c_edge_deg[1], 2.5);
  EXPECT_DOUBLE_EQ(bins.gamma_edge_deg[1], 0.5);
}

// Whatever is counted, the trade's sum returns it: noise, single cells, poles, unequal grids.
TEST(BinnedIntensity, QuadratureReturnsTheTracedFlux) {
  const std::vector<std::vector<double>> planes{{0.0}, {0.0, 90.0, 180.0, 270.0}, {0.0, 11.0, 200.0}};
  const std::vector<std::vector<double>> gammas{
      {0.0, 10.0, 20.0, 90.0}, {0.0, 1.0, 2.0, 5.0, 90.0, 179.0, 180.0}, {90.0, 120.0, 180.0}};
  for (const auto& c : planes) {
    for (const auto& g : gammas) {
      for (std::uint64_t seed = 0; seed < 40; ++seed) {
        std::vector<double> flux(c.size() * g.size(), 0.0);
        Rng rng(1, seed);
        // Sparse for the first seeds: one lit cell, also at the poles.
        for (double& f : flux) f = seed >= 20 || rng.uniform() < 0.1 ? rng.uniform() : 0.0;
        flux[seed % flux.size()] += 1.0;
        const BinnedIntensity result = intensity_from_bins(c, g, flux, {});
        EXPECT_NEAR(total_flux(result.distribution), sum_of(flux), 1e-13 * sum_of(flux));
        EXPECT_EQ(grid_fault(result.distribution), "");
      }
    }
  }
}

// A narrow round beam: axis and flanks stay what they are, on a step that gives seven values across the half
// width.
TEST(BinnedIntensity, KeepsTheShapeOfANarrowBeam) {
  const IntensityDistribution grid = uniform_distribution(30.0, 1.0);
  for (const double sigma_deg : {2.0, 3.0, 6.0}) {
    const auto gauss = [&](double, double g) {
      return 1000.0 * std::exp(-0.5 * g * g / (sigma_deg * sigma_deg));
    };
    const auto flux = binned_flux(grid.c_deg, grid.gamma_deg, gauss);
    const BinnedIntensity result = intensity_from_bins(grid.c_deg, grid.gamma_deg, flux, {});
    // Fourth order in step / sigma remains.
    const double allowed = 0.25 / std::pow(sigma_deg, 4.0);
    EXPECT_NEAR(result.distribution.at(0, 0) / 1000.0, 1.0, allowed) << sigma_deg;
    EXPECT_NEAR(result.closure, 1.0, allowed) << sigma_deg;
    // What dividing by the weights of the sum would do to the axis: half of it goes.
    const double naive = flux[0] * 12.0 / ring_weights_sr(grid.gamma_deg)[0];
    EXPECT_LT(naive, 510.0);
    // Cell means with one factor for the flux lose this much of the peak:
    const IntensityBins bins = intensity_bins(grid.c_deg, grid.gamma_deg);
    IntensityDistribution means = grid;
    for (std::size_t i = 0; i < flux.size(); ++i) means.cd[i] = flux[i] / bins.solid_angle_sr[i];
    const double by_factor = means.at(0, 0) * sum_of(flux) / total_flux(means);
    EXPECT_GT(std::abs(by_factor / 1000.0 - 1.0),
              2.0 * std::abs(result.distribution.at(0, 0) / 1000.0 - 1.0));
  }
}

// A flat top with a sharp edge must not ring, and a smooth wide distribution must come back as it was.
TEST(BinnedIntensity, LeavesEdgesAndWideBeamsAlone) {
  const IntensityDistribution grid = uniform_distribution(15.0, 2.0);
  const auto top = [](double, double g) { return g < 31.0 ? 500.0 : 0.0; };
  const BinnedIntensity flat =
      intensity_from_bins(grid.c_deg, grid.gamma_deg, binned_flux(grid.c_deg, grid.gamma_deg, top), {});
  for (std::size_t g = 0; g < 91; ++g) {
    EXPECT_NEAR(flat.distribution.at(3, g), g <= 15 ? 500.0 : 0.0, 5.0) << grid.gamma_deg[g];
  }
  const auto wide = [](double c, double g) {
    return 100.0 + 80.0 * std::cos(radians(g)) + 15.0 * std::sin(radians(g)) * std::cos(radians(c));
  };
  const BinnedIntensity round =
      intensity_from_bins(grid.c_deg, grid.gamma_deg, binned_flux(grid.c_deg, grid.gamma_deg, wide), {});
  for (std::size_t c = 0; c < grid.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < 91; ++g) {
      EXPECT_NEAR(round.distribution.at(c, g), wide(grid.c_deg[c], grid.gamma_deg[g]), 0.1);
    }
  }
}

/// Flux of `mean(cell)` counts a cell with their noise, in 16 replicates.
template <class Mean>
JackknifedFlux counted(std::size_t cells, std::uint64_t seed, const Mean& mean) {
  constexpr std::size_t kParts = 16;
  JackknifedFlux out(cells, kParts);
  for (std::size_t i = 0; i < cells; ++i) {
    double part[kParts], sum = 0.0;
    for (std::size_t r = 0; r < kParts; ++r) {
      Rng rng(seed, i * kParts + r);
      const double m = mean(i) / kParts;
      part[r] = 0.0;
      // Poisson's counts, by inversion where they are small.
      for (double p = std::exp(-m), at = p, u = m < 30.0 ? rng.uniform() : 0.0; u > at && part[r] < 1000.0;) {
        part[r] += 1.0;
        at += p *= m / part[r];
      }
      if (m >= 30.0) {
        double normal = -6.0;
        for (int k = 0; k < 12; ++k) normal += rng.uniform();
        part[r] = m + std::sqrt(m) * normal;
      }
      sum += part[r];
    }
    const auto row = out.row(i);
    row[0] = sum;
    for (std::size_t r = 0; r < kParts; ++r) row[r + 1] = (sum - part[r]) * kParts / (kParts - 1.0);
  }
  return out;
}

// The spread of the values over seeds against the stated errors, and how steady those are.
TEST(BinnedIntensityStatistical, StandardErrorsHold) {
  const IntensityDistribution grid = uniform_distribution(45.0, 10.0);
  const auto cells = grid.cd.size();
  constexpr int kRuns = 400;
  std::vector<double> sum(cells, 0.0), squares(cells, 0.0), stated(cells, 0.0), stated_squares(cells, 0.0);
  for (int run = 0; run < kRuns; ++run) {
    const JackknifedFlux flux = counted(cells, static_cast<std::uint64_t>(run) + 7, [](std::size_t i) {
      return 1600.0 * (1.0 + static_cast<double>(i % 19));
    });
    const BinnedIntensity result = intensity_from_bins(grid.c_deg, grid.gamma_deg, flux.fluxes(), flux);
    EXPECT_NEAR(total_flux(result.distribution), sum_of(flux.fluxes()), 1e-12 * sum_of(flux.fluxes()));
    for (std::size_t i = 0; i < cells; ++i) {
      sum[i] += result.distribution.cd[i];
      squares[i] += result.distribution.cd[i] * result.distribution.cd[i];
      stated[i] += result.standard_error_cd[i] / kRuns;
      stated_squares[i] += result.standard_error_cd[i] * result.standard_error_cd[i] / kRuns;
    }
  }
  for (std::size_t i = 0; i < cells; ++i) {
    const double mean = sum[i] / kRuns;
    const double spread = std::sqrt(std::max(0.0, squares[i] / kRuns - mean * mean));
    // 5 sigma of a standard deviation from 400 runs is 0.18; the ring factor may add up to a tenth.
    EXPECT_NEAR(spread / stated[i], 1.0, 0.28) << i;
    // 16 replicates alone would scatter by 0.18.
    const double scatter = std::sqrt(std::max(0.0, stated_squares[i] / (stated[i] * stated[i]) - 1.0));
    EXPECT_LT(scatter, 0.12) << i;
  }
}

// Even light of 40 counts a square degree: no value near the poles is noisier than a square of the step
// allows, and one that saw nothing does not claim to know that there is nothing.
TEST(BinnedIntensityStatistical, ThePolesAreNotNoisier) {
  const IntensityDistribution grid = uniform_distribution(5.0, 1.0);
  const IntensityBins bins = intensity_bins(grid.c_deg, grid.gamma_deg);
  const double per_sr = 40.0 * std::pow(180.0 / std::numbers::pi, 2.0);
  const std::size_t gammas = grid.gamma_deg.size();
  const JackknifedFlux flux = counted(grid.cd.size(), 11, [&](std::size_t i) {
    return i % gammas > 90 ? 0.0 : per_sr * bins.solid_angle_sr[i];
  });
  const BinnedIntensity result = intensity_from_bins(grid.c_deg, grid.gamma_deg, flux.fluxes(), flux);
  double squares = 0.0, n = 0.0;
  for (std::size_t c = 0; c < grid.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < 11; ++g) {
      const std::size_t i = c * gammas + g;
      const double off = result.distribution.cd[i] / per_sr - 1.0;
      squares += off * off;
      n += 1.0;
      // sqrt(1 / 40) is 0.158; a pole represents three quarters of a square.
      EXPECT_LT(result.standard_error_cd[i] / per_sr, 0.158 * 1.6) << c << ' ' << g;
    }
    EXPECT_EQ(result.distribution.at(c, 150), 0.0);
    EXPECT_GT(result.standard_error_cd[c * gammas + 150], 0.0);
  }
  EXPECT_LT(std::sqrt(squares / n), 0.2);
  // Without pooling gamma 1 would be noisier than the horizon by the square root of 11.5 at least.
  EXPECT_LT(std::sqrt(bins.solid_angle_sr[1] * per_sr), 0.3 * std::sqrt(40.0));
}

TEST(BinnedIntensity, RefusesWhatIsNotFlux) {
  const std::vector<double> c{0.0}, g{0.0, 90.0};
  EXPECT_THROW(intensity_from_bins(c, g, std::vector<double>{1.0}, {}), InputError);
  EXPECT_THROW(intensity_from_bins(c, g, std::vector<double>{1.0, -1.0}, {}), InputError);
  EXPECT_THROW(intensity_from_bins(c, g, std::vector<double>{1.0, std::nan("")}, {}), InputError);
  EXPECT_THROW(intensity_from_bins(c, g, std::vector<double>{1.0, 1.0}, JackknifedFlux(1, 16)), InputError);
}

TEST(BinnedIntensity, NothingIsNothing) {
  const std::vector<double> c{0.0, 180.0}, g{0.0, 90.0, 180.0};
  const BinnedIntensity result = intensity_from_bins(c, g, std::vector<double>(6, 0.0), {});
  EXPECT_EQ(total_flux(result.distribution), 0.0);
  EXPECT_EQ(result.closure, 1.0);
}

/// Flux by tents on a grid of 60 x 10 degrees, from 4 M points of a distribution I(gamma).
template <class Intensity>
std::vector<double> tents(const Intensity& intensity) {
  std::vector<double> flux(std::size_t{6} * 19, 0.0);
  constexpr int kC = 60, kU = 20'000;
  for (int j = 0; j < kU; ++j) {
    const double u = 1.0 - 2.0 * (j + 0.5) / kU, gamma = degrees(std::acos(u));
    const auto g = std::min<std::size_t>(static_cast<std::size_t>(gamma / 10.0), 17);
    const double t = gamma / 10.0 - static_cast<double>(g);
    const double each = intensity(gamma) * 4.0 * std::numbers::pi / kU / kC;
    for (int k = 0; k < kC; ++k) {
      const double c = 6.0 * (k + 0.5) / kC;
      const auto left = static_cast<std::size_t>(c);
      for (const std::size_t plane : {left, (left + 1) % 6}) {
        const double share =
            plane == left ? 1.0 - (c - static_cast<double>(left)) : c - static_cast<double>(left);
        flux[plane * 19 + g] += share * (1.0 - t) * each;
        flux[plane * 19 + g + 1] += share * t * each;
      }
    }
  }
  return flux;
}

TEST(BinnedIntensity, TentsGiveBackIntensityAndFlux) {
  std::vector<double> c, g;
  for (int i = 0; i < 6; ++i) c.push_back(60.0 * i);
  for (int i = 0; i < 19; ++i) g.push_back(10.0 * i);
  const std::vector<double> even = tents([](double) { return 3.0; });
  const BinnedIntensity uniform = intensity_from_tents(c, g, even);
  EXPECT_NEAR(uniform.closure, 1.0, 1e-2);
  for (const double cd : uniform.distribution.cd) EXPECT_NEAR(cd, 3.0, 0.03);
  EXPECT_NEAR(total_flux(uniform.distribution), 12.0 * std::numbers::pi, 1e-9);
  const BinnedIntensity lambert = intensity_from_tents(
      c, g, tents([](double gamma) { return std::max(0.0, std::cos(radians(gamma))); }), {});
  EXPECT_NEAR(total_flux(lambert.distribution), std::numbers::pi, 2e-3);
  for (std::size_t k = 0; k < 8; ++k)
    EXPECT_NEAR(lambert.distribution.at(2, k), std::cos(radians(10.0 * static_cast<double>(k))), 0.015) << k;
  EXPECT_THROW(intensity_from_tents(c, std::vector<double>{0, 90}, std::vector<double>(12, 1.0), {}),
               InputError);
}

}  // namespace
}  // namespace lucerna
