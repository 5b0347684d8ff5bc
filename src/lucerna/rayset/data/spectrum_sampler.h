// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/rays.h"

namespace lucerna {

/// Draws wavelengths from a spectral table, the density piecewise linear between its points.
class SpectrumSampler {
 public:
  /// A table of one point, or of zero power, draws its first wavelength. The table must not be empty.
  explicit SpectrumSampler(const SpectralTable& table);

  /// The wavelength in nm below which the share `u` in [0, 1) of the power lies.
  float wavelength_nm(double u) const;

 private:
  SpectralTable table_;
  std::vector<double> cumulative_;
};

}  // namespace lucerna
