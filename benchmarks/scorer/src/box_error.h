// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

namespace bench {

/// A mean over replicates with its standard error.
struct Estimate {
  double mean = 0.0, standard_error = 0.0;
};
Estimate mean_of(const std::vector<double>& values);

/// Measure and target of some cells, and each replicate's light in them. Cells of measure 0 do not count.
struct CellLight {
  std::vector<double> measure, target;
  std::vector<std::vector<double>> by_replicate;
};

/// |s f - t| / |t| with densities f and t, l2 weighted by measure; s by shape.
struct BoxError {
  /// With noise, the noise, and without it: excess^2 = value^2 - floor^2, not below 0.
  double value = 0.0, floor = 0.0, excess = 0.0, standard_error = 0.0;
  double scale = 1.0;
  /// Largest deviation of a cell as a share of the brightest of the target.
  Estimate worst;
};

/// E = value^2 - floor^2 has no bias; with residuals m and the covariance S of one of R replicates its
/// variance is 4 m'Sm / R + 2 trace(S^2) / R^2, both from the replicates. Needs two replicates or more, light
/// in the target. A dark result has an error of 1.
BoxError box_error(const CellLight& cells);

/// Cells of n x n (or n x 1) boxes out of 48 x 48 (or 48 x 1).
CellLight merged(const CellLight& fine, int rows, int n);

/// Normalised mean absolute error, sum |A - B| / sum A with A (target) and B (result) of one sum, and what a
/// perfect optic would have from noise alone with these rays.
struct AbsoluteError {
  double value = 0.0, noise = 0.0;
};
AbsoluteError absolute_error(const CellLight& cells);

/// Standard deviation over mean, of the cells with a measure > 0; with noise taken out, and what noise adds.
struct Unevenness {
  double raw = 0.0, without_noise = 0.0;
};
Unevenness unevenness(const CellLight& cells);

}  // namespace bench
