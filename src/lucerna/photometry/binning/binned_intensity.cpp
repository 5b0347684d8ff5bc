// SPDX-License-Identifier: Apache-2.0
#include "lucerna/photometry/binning/binned_intensity.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/binning/node_errors.h"

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

void check_bins(std::span<const double> flux, const JackknifedFlux& replicated, std::size_t cells) {
  if (flux.size() != cells || (replicated.cells() != 0 && replicated.cells() != cells)) {
    throw InputError(
        fmt::format("{} fluxes and {} errors for {} bins", flux.size(), replicated.cells(), cells));
  }
  for (std::size_t i = 0; i < cells; ++i) {
    if (!std::isfinite(flux[i]) || flux[i] < 0.0) {
      throw InputError(fmt::format("flux {} in bin {}", flux[i], i));
    }
  }
}

/// Intensities of the whole run, and the variances and solid angles behind them.
struct PooledRings {
  std::vector<double> cd, variance, solid_angle_sr;
  /// Of each ring, how many planes to either side of a value are in it.
  std::vector<std::size_t> planes;
};

/// Pools rings that shrink towards the poles along C (see the header).
class RingPool {
 public:
  RingPool(std::span<const double> c_deg, std::span<const double> gamma_deg, const IntensityBins& bins)
      : c_deg_(c_deg), gamma_deg_(gamma_deg), bins_(bins), width_(plane_weights(c_deg)) {}

  /// `solid_angle_sr`: what a bin's flux is divided by.
  PooledRings pool(std::span<const double> flux, const JackknifedFlux& replicated,
                   const std::vector<double>& solid_angle_sr) const {
    const std::size_t planes = c_deg_.size(), gammas = gamma_deg_.size();
    const std::size_t values = std::max<std::size_t>(1, replicated.replicates() + 1);
    const bool errors = replicated.replicates() >= 2;
    PooledRings out{std::vector<double>(flux.size()), std::vector<double>(errors ? flux.size() : 0),
                    solid_angle_sr, std::vector<std::size_t>(gammas)};
    std::vector<double> ring(planes * values), pooled(planes * values);
    for (std::size_t g = 0; g < gammas; ++g) {
      for (std::size_t c = 0; c < planes; ++c) {
        const std::size_t i = c * gammas + g;
        ring[c * values] = flux[i] / solid_angle_sr[i];
        for (std::size_t r = 1; r < values; ++r)
          ring[c * values + r] = replicated.row(i)[r] / solid_angle_sr[i];
      }
      out.planes[g] = pool_ring(g, ring, pooled, values, out);
      for (std::size_t c = 0; c < planes; ++c) {
        const std::size_t i = c * gammas + g;
        out.cd[i] = pooled[c * values];
        if (!errors) continue;
        const auto row = std::span(pooled).subspan(c * values, values);
        const double se = Jackknife({row.begin(), row.end()}).estimate().standard_error;
        out.variance[i] = se * se;
      }
    }
    return out;
  }

 private:
  /// The length in C, in degrees, of the arc of ring `g` over which plane `c` is averaged.
  double arc_deg(std::size_t c, std::size_t g) const {
    const double gamma = gamma_deg_[g], height = bins_.gamma_edge_deg[g + 1] - bins_.gamma_edge_deg[g];
    if (gamma == 0.0 || gamma == 180.0) return 360.0;
    return std::min(360.0, std::max(360.0 * width_[c], height / std::sin(radians(gamma))));
  }

  /// Averages all planes of a ring, its mean kept; returns the largest number of planes to either side.
  std::size_t pool_ring(std::size_t g, const std::vector<double>& ring, std::vector<double>& pooled,
                        std::size_t values, PooledRings& out) const {
    const std::size_t planes = c_deg_.size();
    std::fill(pooled.begin(), pooled.end(), 0.0);
    std::size_t widest = 0;
    for (std::size_t c = 0; c < planes; ++c) {
      const double arc = arc_deg(c, g);
      if (arc <= 360.0 * width_[c] * (1.0 + 1e-12)) {  // the plane's own bin, as it is
        std::copy_n(ring.begin() + static_cast<std::ptrdiff_t>(c * values), values,
                    pooled.begin() + static_cast<std::ptrdiff_t>(c * values));
        continue;
      }
      std::size_t used = 0;
      for (std::size_t k = 0; k < planes; ++k) {
        const double share = overlap(c, arc, k);
        if (share <= 0.0) continue;
        ++used;
        for (std::size_t r = 0; r < values; ++r) pooled[c * values + r] += share * ring[k * values + r];
      }
      widest = std::max(widest, used / 2);
      out.solid_angle_sr[c * gamma_deg_.size() + g] *= arc / (360.0 * width_[c]);
    }
    for (std::size_t r = 0; widest > 0 && r < values; ++r) keep_mean(ring, pooled, values, r);
    return widest;
  }

  /// The share of an arc about plane `c` that lies in the bin of plane `k`.
  double overlap(std::size_t c, double arc, std::size_t k) const {
    if (arc >= 360.0) return width_[k];
    const double low = bins_.c_edge_deg[k] - c_deg_[c], wide = 360.0 * width_[k];
    double sum = 0.0;
    for (const double turn : {-360.0, 0.0, 360.0}) {
      const double from = std::max(low + turn, -0.5 * arc), to = std::min(low + turn + wide, 0.5 * arc);
      sum += std::max(0.0, to - from);
    }
    return sum / arc;
  }

  /// Unequal planes would let pooling change the mean of a ring, and with it the flux.
  void keep_mean(const std::vector<double>& ring, std::vector<double>& pooled, std::size_t values,
                 std::size_t r) const {
    double before = 0.0, after = 0.0;
    for (std::size_t c = 0; c < width_.size(); ++c) {
      before += width_[c] * ring[c * values + r];
      after += width_[c] * pooled[c * values + r];
    }
    if (after <= 0.0) return;
    for (std::size_t c = 0; c < width_.size(); ++c) pooled[c * values + r] *= before / after;
  }

  std::span<const double> c_deg_, gamma_deg_;
  const IntensityBins& bins_;
  std::vector<double> width_;
};

/// The factors on rings and the one that makes the flux exact, on values and errors.
void close_flux(std::span<const double> flux, PooledRings rings, const std::vector<double>& factors,
                BinnedIntensity& result) {
  IntensityDistribution& d = result.distribution;
  const std::size_t gammas = d.gamma_deg.size();
  d.cd = std::move(rings.cd);
  std::vector<double> errors;
  if (!rings.variance.empty()) errors = pooled_errors(d, rings.variance, rings.solid_angle_sr, rings.planes);
  for (std::size_t i = 0; i < d.cd.size(); ++i) d.cd[i] *= factors[i % gammas];
  const double wanted = std::accumulate(flux.begin(), flux.end(), 0.0);
  if (wanted > 0.0) {
    result.closure = wanted / total_flux(d);
    scale(d, result.closure);
  }
  for (std::size_t i = 0; i < errors.size(); ++i) errors[i] *= factors[i % gammas] * result.closure;
  result.standard_error_cd = std::move(errors);
}

}  // namespace

IntensityBins intensity_bins(std::span<const double> c_deg, std::span<const double> gamma_deg) {
  static_cast<void>(zero_distribution({c_deg.begin(), c_deg.end()},
                                      {gamma_deg.begin(), gamma_deg.end()}));  // checks the angles
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

BinnedIntensity intensity_from_bins(std::span<const double> c_deg, std::span<const double> gamma_deg,
                                    std::span<const double> flux, const JackknifedFlux& replicated,
                                    FluxUnit unit) {
  const IntensityBins bins = intensity_bins(c_deg, gamma_deg);
  check_bins(flux, replicated, bins.solid_angle_sr.size());
  BinnedIntensity result;
  IntensityDistribution& d = result.distribution;
  d = zero_distribution({c_deg.begin(), c_deg.end()}, {gamma_deg.begin(), gamma_deg.end()}, unit);
  PooledRings rings = RingPool(c_deg, gamma_deg, bins).pool(flux, replicated, bins.solid_angle_sr);
  d.cd = rings.cd;
  const std::vector<double> factors = ring_factors(gamma_deg, ring_means(d));
  close_flux(flux, std::move(rings), factors, result);
  return result;
}

BinnedIntensity intensity_from_tents(std::span<const double> c_deg, std::span<const double> gamma_deg,
                                     std::span<const double> flux, const JackknifedFlux& replicated,
                                     FluxUnit unit) {
  const IntensityBins bins = intensity_bins(c_deg, gamma_deg);
  check_bins(flux, replicated, bins.solid_angle_sr.size());
  if (gamma_deg.front() != 0.0 || gamma_deg.back() != 180.0)
    throw InputError("tents: expected gammas from 0 to 180");
  BinnedIntensity result;
  result.distribution =
      zero_distribution({c_deg.begin(), c_deg.end()}, {gamma_deg.begin(), gamma_deg.end()}, unit);
  const std::vector<double> width = plane_weights(c_deg), tents = tent_integrals(gamma_deg);
  const std::size_t gammas = gamma_deg.size();
  std::vector<double> solid_angle(flux.size());
  for (std::size_t i = 0; i < flux.size(); ++i)
    solid_angle[i] = 2.0 * std::numbers::pi * width[i / gammas] * tents[i % gammas];
  close_flux(flux, RingPool(c_deg, gamma_deg, bins).pool(flux, replicated, solid_angle),
             std::vector<double>(gammas, 1.0), result);
  return result;
}

}  // namespace lucerna
