// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/formats/common/ray_wavelengths.h"

#include <fmt/format.h>

namespace lucerna {

namespace {

constexpr float kGreen_nm = 555.0F;

}  // namespace

RayWavelengths::RayWavelengths(const RaySetHeader& header, std::vector<std::string>& warnings)
    : column_(find_column(header.columns, ColumnKind::wavelength_nm)),
      one_nm_(header.wavelength_nm.value_or(kGreen_nm)) {
  if (column_) return;
  if (!header.spectra.empty() && !header.spectra.front().wavelength_nm.empty()) {
    spectrum_.emplace(header.spectra.front());
    warnings.push_back("the spectral table is written as one wavelength per ray, drawn evenly from it");
  } else if (!header.wavelength_nm) {
    warnings.push_back(fmt::format("no wavelengths are known: {} nm is written for all rays", kGreen_nm));
  }
}

}  // namespace lucerna
