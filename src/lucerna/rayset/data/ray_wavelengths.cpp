// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/data/ray_wavelengths.h"

#include <fmt/format.h>

#include <algorithm>

#include "lucerna/random.h"
#include "lucerna/rayset/data/luminous_spectrum.h"

namespace lucerna {

RayWavelengths::RayWavelengths(const RaySetHeader& header, FluxUnit drawn, float unknown_nm)
    : column_(find_column(header.columns, ColumnKind::wavelength_nm)),
      index_(find_column(header.columns, ColumnKind::spectrum_index)),
      one_nm_(header.wavelength_nm),
      unknown_nm_(unknown_nm) {
  if (column_ || std::ranges::any_of(header.spectra, [](const auto& s) { return s.wavelength_nm.empty(); }))
    return;
  for (const SpectralTable& table : header.spectra)
    spectra_.emplace_back(drawn == FluxUnit::lumen ? luminous_spectrum(table) : table);
}

float RayWavelengths::of(const RayBlock& block, std::size_t i, std::uint64_t number) const {
  if (column_) return block.extra[*column_][i];
  if (spectra_.empty()) return one_nm_.value_or(unknown_nm_);
  const double index = index_ ? static_cast<double>(block.extra[*index_][i]) : 1.0;
  const bool is_named = index >= 1.0 && index <= static_cast<double>(spectra_.size());
  // Any seed will do: another would give other rays other wavelengths.
  const double u = Rng(0x6C616D626461U, number).uniform();
  return spectra_[is_named ? static_cast<std::size_t>(index) - 1 : 0].wavelength_nm(u);
}

std::string wavelengths_warning(const RayWavelengths& wavelengths) {
  if (wavelengths.are_drawn())
    return "the spectral table is written as one wavelength per ray, drawn from it";
  if (wavelengths.are_known()) return {};
  return fmt::format("no wavelengths are known: {} nm is written for all rays", kGreen_nm);
}

}  // namespace lucerna
