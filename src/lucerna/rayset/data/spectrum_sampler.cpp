// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/spectrum_sampler.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

SpectrumSampler::SpectrumSampler(const SpectralTable& table)
    : table_(table), cumulative_(table.wavelength_nm.size(), 0.0) {
  LUCERNA_CHECK(!cumulative_.empty(), "an empty spectral table");
  for (std::size_t i = 1; i < cumulative_.size(); ++i) {
    const double width =
        static_cast<double>(table.wavelength_nm[i]) - static_cast<double>(table.wavelength_nm[i - 1]);
    const double height =
        static_cast<double>(table.relative_power[i]) + static_cast<double>(table.relative_power[i - 1]);
    cumulative_[i] = cumulative_[i - 1] + 0.5 * width * height;
  }
}

float SpectrumSampler::wavelength_nm(double u) const {
  const double wanted = u * cumulative_.back();
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), wanted);
  if (above == cumulative_.begin() || above == cumulative_.end()) return table_.wavelength_nm.front();
  const auto i = static_cast<std::size_t>(above - cumulative_.begin());
  const double width =
      static_cast<double>(table_.wavelength_nm[i]) - static_cast<double>(table_.wavelength_nm[i - 1]);
  const double a = table_.relative_power[i - 1], b = table_.relative_power[i];
  // Power up to the share t of the interval: width (a t + (b - a) t^2 / 2) = rest, solved without
  // cancellation.
  const double rest = (wanted - cumulative_[i - 1]) / width;
  if (!(rest > 0.0)) return table_.wavelength_nm[i - 1];
  const double t = 2.0 * rest / (a + std::sqrt(std::max(0.0, a * a + 2.0 * (b - a) * rest)));
  return static_cast<float>(static_cast<double>(table_.wavelength_nm[i - 1]) + width * std::min(t, 1.0));
}

}  // namespace lucerna
