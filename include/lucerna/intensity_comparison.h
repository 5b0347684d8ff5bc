// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "lucerna/estimate.h"
#include "lucerna/intensity.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// How `compare_distributions` compares.
struct CompareOptions {
  /// Standard errors of the reference's and the test's values (layout of `cd`); empty = known exactly.
  std::span<const double> reference_error_cd{}, test_error_cd{};
  bool align = true;  ///< also look for the rotation that fits best
};

/// How the test must be turned to fit the reference best, and what difference then is left.
struct Alignment {
  double tilt_deg = 0.0;           ///< by how much the axis tilts
  double tilt_toward_c_deg = 0.0;  ///< C plane that nadir tilts toward
  double turn_deg = 0.0;           ///< about the vertical, counter-clockwise in C
  double relative_rms = 0.0;       ///< after it
};

/// Standard errors of the figures below that the given standard errors of the values make; NaN where none
/// were given.
struct ComparisonErrors {
  /// Each in the unit of its figure.
  double relative_rms, bergen_fit, bergen_fit_unweighted, flux_ratio, peak_ratio, wasserstein_deg, overlap;
};

/// How far a test distribution is from a reference. Sums run over the union of both grids (both are bilinear
/// between angles), each angle with the solid angle of its cell. A = reference, B = test.
struct DistributionComparison {
  double relative_rms = 0.0;  ///< sqrt(sum w (A-B)^2 / sum w A^2)
  double bergen_fit = 0.0;    ///< 100 (1 - sqrt(sum w (A-B)^2 / sum w (A+B)^2)); 100 = equal. Bergen, LR&T 44
                              ///< (2012) 27, weighted by solid angle
  /// The same with every grid value counted once.
  double bergen_fit_unweighted = 0.0;
  double flux_ratio = 0.0;  ///< B / A, by the trade's quadrature
  double peak_ratio = 0.0;  ///< B / A of the largest values
  double wasserstein_deg =
      0.0;                   ///< mean angle that light must move to make B's shape from A's (unit flux each)
  double overlap = 0.0;      ///< 1 - 1/2 sum w |a - b| of unit-flux a, b: share of light in the right place
  double noise_floor = 0.0;  ///< relative RMS that the given standard errors alone would give
  double excess = 0.0;       ///< sqrt(max(0, relative_rms^2 - noise_floor^2))
  /// If CompareOptions::align asked for it.
  std::optional<Alignment> alignment;
  /// Standard errors of all of these.
  ComparisonErrors errors{};

  /// `relative_rms` with its standard error.
  Estimate rms() const { return {relative_rms, errors.relative_rms}; }
  /// `bergen_fit` with its standard error.
  Estimate bergen() const { return {bergen_fit, errors.bergen_fit}; }
  /// `bergen_fit_unweighted` with its standard error.
  Estimate bergen_unweighted() const { return {bergen_fit_unweighted, errors.bergen_fit_unweighted}; }
  /// `flux_ratio` with its standard error.
  Estimate flux() const { return {flux_ratio, errors.flux_ratio}; }
  /// `peak_ratio` with its standard error.
  Estimate peak() const { return {peak_ratio, errors.peak_ratio}; }
  /// `wasserstein_deg` with its standard error.
  Estimate wasserstein() const { return {wasserstein_deg, errors.wasserstein_deg}; }
  /// `overlap` with its standard error.
  Estimate overlapping() const { return {overlap, errors.overlap}; }
};

/// Compares. Throws InputError if a grid breaks its rules, units differ, or either is dark. Wasserstein-1 is
/// exact for up to 600 differing angles a side and merges nearest ones beyond. Errors are the scatter of
/// eight comparisons of values moved by their standard errors at random (a parametric bootstrap; each error
/// is good to a quarter). Deterministic; thread safe; about 1 s.
[[nodiscard]] DistributionComparison compare_distributions(const IntensityDistribution& reference,
                                                           const IntensityDistribution& test,
                                                           const CompareOptions& options = {});

/// Wasserstein-1 distance in degrees between the shapes (unit flux each) alone.
double wasserstein_deg(const IntensityDistribution& a, const IntensityDistribution& b);

}  // namespace lucerna
#pragma GCC visibility pop
