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
  /// Standard errors of the reference's and the test's flux (in its unit): a trace, whose rays land in one
  /// direction or another, knows the sum better than independent values would.
  std::optional<double> reference_flux_error{}, test_flux_error{};
  bool align = true;  ///< also look for the rotation that fits best
};

/// How the test must be turned to fit the reference best, and what difference then is left. The C plane has
/// no meaning where the tilt is no larger than its error.
struct Alignment {
  Estimate tilt_deg;           ///< by how much the axis tilts
  Estimate tilt_toward_c_deg;  ///< C plane that nadir tilts toward
  Estimate turn_deg;      ///< about the vertical, counter-clockwise in C; 0 +- 104 where all turns fit alike
  Estimate relative_rms;  ///< after it
};

/// How far a test distribution is from a reference. Sums run over the union of both grids (both are bilinear
/// between angles), each angle with the solid angle of its cell. A = reference, B = test. Standard errors are
/// what those of the values make; NaN where none were given.
struct DistributionComparison {
  Estimate relative_rms;  ///< sqrt(sum w (A-B)^2 / sum w A^2)
  /// 100 (1 - sqrt(sum w (A-B)^2 / sum w (A+B)^2)); 100 = equal. Bergen, LR&T 44 (2012) 27, weighted by solid
  /// angle
  Estimate bergen_fit;
  /// The same with every grid value counted once.
  Estimate bergen_fit_unweighted;
  Estimate flux_ratio;       ///< B / A, by the trade's quadrature
  Estimate peak_ratio;       ///< B / A of the largest values
  Estimate wasserstein_deg;  ///< mean angle that light must move to make B's shape from A's (unit flux each)
  Estimate overlap;          ///< 1 - 1/2 sum w |a - b| of unit-flux a, b: share of light in the right place
  double noise_floor = 0.0;  ///< relative RMS that the given standard errors alone would give
  Estimate excess;           ///< sqrt(max(0, relative_rms^2 - noise_floor^2))
  /// If CompareOptions::align asked for it.
  std::optional<Alignment> alignment;
};

/// Compares. Throws InputError if a grid breaks its rules, units differ, or either is dark. Wasserstein-1 is
/// exact for up to 600 differing angles a side and merges nearest ones beyond. Errors are the scatter of
/// eight comparisons of values moved by their standard errors at random (a parametric bootstrap; each error
/// is good to a quarter). Deterministic; thread safe; about 1 s, 2 s with alignment and errors.
[[nodiscard]] DistributionComparison compare_distributions(const IntensityDistribution& reference,
                                                           const IntensityDistribution& test,
                                                           const CompareOptions& options = {});

/// Wasserstein-1 distance in degrees between the shapes (unit flux each) alone.
double wasserstein_deg(const IntensityDistribution& a, const IntensityDistribution& b);

}  // namespace lucerna
#pragma GCC visibility pop
