// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binned_intensity.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lucerna/core/error.h"
#include "lucerna/photometry/flux.h"

namespace lucerna {

namespace {

/// Second derivative by the three-point formula times `width`^2, no larger than the smaller first difference.
double limited_curvature(double before, double here, double after, double gap_before, double gap_after,
                         double width) {
  const double down = here - before, up = after - here;
  const double curvature =
      2.0 * (up / gap_after - down / gap_before) / (gap_before + gap_after) * width * width;
  const double limit = std::min(std::abs(down), std::abs(up));
  return std::clamp(curvature, -limit, limit);
}

/// The factor R / A of each ring (see the header).
std::vector<double> ring_factors(std::span<const double> gamma_deg, const std::vector<double>& means) {
  const std::size_t n = means.size();
  const bool nadir = gamma_deg.front() == 0.0, zenith = gamma_deg.back() == 180.0;
  std::vector<double> factors(n, 1.0);
  for (std::size_t g = 0; g < n; ++g) {
    if (means[g] <= 0.0) continue;
    double correction = 0.0;
    if (g == 0) {
      if (nadir) correction = -(means[1] - means[0]) / 9.0;
    } else if (g + 1 == n) {
      if (zenith) correction = -(means[n - 2] - means[n - 1]) / 9.0;
    } else {
      const double before = gamma_deg[g] - gamma_deg[g - 1], after = gamma_deg[g + 1] - gamma_deg[g];
      correction =
          -limited_curvature(means[g - 1], means[g], means[g + 1], before, after, 0.5 * (before + after)) /
          8.0;
    }
    // A dark ring between bright ones must not be driven below zero.
    factors[g] = std::max(0.5, 1.0 + correction / means[g]);
  }
  return factors;
}

/// The wedges of a polar cap are one direction: each gets the mean.
void even_out_pole(IntensityDistribution& d, const std::vector<double>& planes, std::size_t g) {
  double mean = 0.0;
  for (std::size_t c = 0; c < planes.size(); ++c) mean += planes[c] * d.at(c, g);
  for (std::size_t c = 0; c < planes.size(); ++c) d.at(c, g) = mean;
}

void check_bins(std::span<const double> flux, std::span<const double> error, std::size_t cells) {
  if (flux.size() != cells || (!error.empty() && error.size() != cells)) {
    throw InputError(fmt::format("{} fluxes and {} errors for {} bins", flux.size(), error.size(), cells));
  }
  for (std::size_t i = 0; i < cells; ++i) {
    if (!std::isfinite(flux[i]) || flux[i] < 0.0) {
      throw InputError(fmt::format("flux {} in bin {}", flux[i], i));
    }
  }
}

/// The integral over each tent in gamma of sin gamma: from the neighbour before to the neighbour after.
std::vector<double> tent_integrals(std::span<const double> gamma_deg) {
  std::vector<double> integrals(gamma_deg.size());
  for (std::size_t g = 0; g < gamma_deg.size(); ++g) {
    const double here = radians(gamma_deg[g]);
    double sum = g == 0 ? std::cos(here) : (g + 1 == gamma_deg.size() ? -std::cos(here) : 0.0);
    if (g > 0) {
      const double before = radians(gamma_deg[g - 1]);
      sum += (std::sin(here) - std::sin(before)) / (here - before);
    }
    if (g + 1 < gamma_deg.size()) {
      const double after = radians(gamma_deg[g + 1]);
      sum -= (std::sin(after) - std::sin(here)) / (after - here);
    }
    integrals[g] = sum;
  }
  return integrals;
}

/// The factor that makes the flux exact, and the errors of all values; those of a polar cap are of its mean.
void close_flux(std::span<const double> flux, std::span<const double> flux_standard_error,
                const std::vector<double>& solid_angle_sr, const std::vector<double>& factors,
                BinnedIntensity& result) {
  IntensityDistribution& d = result.distribution;
  const std::size_t planes = d.c_deg.size(), gammas = d.gamma_deg.size();
  const std::vector<double> width = plane_weights(d.c_deg);
  const bool nadir = d.gamma_deg.front() == 0.0, zenith = d.gamma_deg.back() == 180.0;
  const double wanted = std::accumulate(flux.begin(), flux.end(), 0.0);
  if (wanted > 0.0) {
    result.closure = wanted / total_flux(d);
    scale(d, result.closure);
  }
  if (flux_standard_error.empty()) return;
  result.standard_error_cd.resize(d.cd.size());
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    result.standard_error_cd[i] =
        flux_standard_error[i] / solid_angle_sr[i] * factors[i % gammas] * result.closure;
  }
  // The error of a cap's mean: the wedges are counted independently.
  for (const std::size_t g : {std::size_t{0}, gammas - 1}) {
    if (!(g == 0 ? nadir : zenith)) continue;
    double variance = 0.0;
    for (std::size_t c = 0; c < planes; ++c) {
      const double e = width[c] * result.standard_error_cd[c * gammas + g];
      variance += e * e;
    }
    for (std::size_t c = 0; c < planes; ++c) result.standard_error_cd[c * gammas + g] = std::sqrt(variance);
  }
}

}  // namespace

IntensityBins intensity_bins(std::span<const double> c_deg, std::span<const double> gamma_deg) {
  zero_distribution({c_deg.begin(), c_deg.end()}, {gamma_deg.begin(), gamma_deg.end()});  // checks the angles
  IntensityBins bins;
  const std::size_t planes = c_deg.size(), gammas = gamma_deg.size();
  bins.c_edge_deg.resize(planes, 0.0);
  if (planes > 1) {
    for (std::size_t c = 0; c < planes; ++c) {
      bins.c_edge_deg[c] = 0.5 * ((c == 0 ? c_deg[planes - 1] - 360.0 : c_deg[c - 1]) + c_deg[c]);
    }
  }
  bins.gamma_edge_deg.resize(gammas + 1);
  bins.gamma_edge_deg.front() = gamma_deg.front();
  bins.gamma_edge_deg.back() = gamma_deg.back();
  for (std::size_t g = 1; g < gammas; ++g) bins.gamma_edge_deg[g] = 0.5 * (gamma_deg[g - 1] + gamma_deg[g]);
  const std::vector<double> width = plane_weights(c_deg);
  for (std::size_t c = 0; c < planes; ++c) {
    for (std::size_t g = 0; g < gammas; ++g) {
      const double a = radians(bins.gamma_edge_deg[g]), b = radians(bins.gamma_edge_deg[g + 1]);
      // cos a - cos b, without cancellation in small caps
      const double band = 2.0 * std::sin(0.5 * (a + b)) * std::sin(0.5 * (b - a));
      bins.solid_angle_sr.push_back(2.0 * std::numbers::pi * width[c] * band);
    }
  }
  return bins;
}

BinnedIntensity intensity_from_bins(std::span<const double> c_deg, std::span<const double> gamma_deg,
                                    std::span<const double> flux, std::span<const double> flux_standard_error,
                                    FluxUnit unit) {
  const IntensityBins bins = intensity_bins(c_deg, gamma_deg);
  check_bins(flux, flux_standard_error, bins.solid_angle_sr.size());
  BinnedIntensity result;
  IntensityDistribution& d = result.distribution;
  d = zero_distribution({c_deg.begin(), c_deg.end()}, {gamma_deg.begin(), gamma_deg.end()}, unit);
  const std::size_t gammas = gamma_deg.size();
  for (std::size_t i = 0; i < d.cd.size(); ++i) d.cd[i] = flux[i] / bins.solid_angle_sr[i];
  const std::vector<double> width = plane_weights(c_deg);
  const bool nadir = gamma_deg.front() == 0.0, zenith = gamma_deg.back() == 180.0;
  if (nadir) even_out_pole(d, width, 0);
  if (zenith) even_out_pole(d, width, gammas - 1);

  std::vector<double> factors = ring_factors(gamma_deg, ring_means(d));
  for (std::size_t i = 0; i < d.cd.size(); ++i) d.cd[i] *= factors[i % gammas];
  close_flux(flux, flux_standard_error, bins.solid_angle_sr, factors, result);
  return result;
}

BinnedIntensity intensity_from_tents(std::span<const double> c_deg, std::span<const double> gamma_deg,
                                     std::span<const double> flux,
                                     std::span<const double> flux_standard_error, FluxUnit unit) {
  BinnedIntensity result;
  IntensityDistribution& d = result.distribution;
  d = zero_distribution({c_deg.begin(), c_deg.end()}, {gamma_deg.begin(), gamma_deg.end()}, unit);
  check_bins(flux, flux_standard_error, d.cd.size());
  if (gamma_deg.front() != 0.0 || gamma_deg.back() != 180.0)
    throw InputError("tents: expected gammas from 0 to 180");
  const std::vector<double> width = plane_weights(c_deg), tents = tent_integrals(gamma_deg);
  const std::size_t gammas = gamma_deg.size();
  std::vector<double> solid_angle(d.cd.size());
  for (std::size_t i = 0; i < d.cd.size(); ++i) {
    solid_angle[i] = 2.0 * std::numbers::pi * width[i / gammas] * tents[i % gammas];
    d.cd[i] = flux[i] / solid_angle[i];
  }
  even_out_pole(d, width, 0);
  even_out_pole(d, width, gammas - 1);
  close_flux(flux, flux_standard_error, solid_angle, std::vector<double>(gammas, 1.0), result);
  return result;
}

}  // namespace lucerna
