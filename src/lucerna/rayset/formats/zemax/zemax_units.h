// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "lucerna/core/io/error.h"
#include "lucerna/rays.h"

/// What Zemax's binary and text files have in common: the code for lengths, and wavelengths in micrometres.
namespace lucerna::zemax {

inline constexpr std::array<std::string_view, 5> kUnits{"m", "inch", "cm", "feet", "mm"};

/// The code of a unit; UsageError if the format does not know it.
inline std::int32_t unit_code(std::string_view unit) {
  const auto found = std::ranges::find(kUnits, unit);
  if (found == kUnits.end()) {
    throw UsageError(fmt::format("zemax: lengths in {}, not {}", fmt::join(kUnits, ", "), unit));
  }
  return static_cast<std::int32_t>(found - kUnits.begin());
}

inline constexpr double kNmPerWavelength = 1000.0;

/// Rays have wavelengths of their own only where flux is in watt.
inline bool is_spectral(const RaySetHeader& header) {
  return find_column(header.columns, ColumnKind::wavelength_nm) && header.flux_unit == FluxUnit::watt;
}

}  // namespace lucerna::zemax
