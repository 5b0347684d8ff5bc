// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lucerna/rays.h"

/// Where TM-25-13 puts things; shared by reader and writer (tm25.h).
namespace lucerna::tm25 {

// Block A, the file header.
inline constexpr std::size_t kVersion = 4, kCreationMethod = 8, kFluxLm = 12, kFluxW = 16, kRayCount = 20,
                             kDate = 28, kDateSize = 28, kStartPosition = 56, kSpectralId = 60,
                             kWavelength = 64, kMinWavelength = 68, kMaxWavelength = 72, kTableCount = 76,
                             kItemCount = 80, kTextSize = 84;
// Block B, flags, and block C, nine texts of 1000 UTF-32 code points.
inline constexpr std::size_t kFlags = 256, kTexts = 288, kTextCodes = 1000,
                             kHeaderSize = kTexts + 36 * kTextCodes;
// Block D is padded to this; block E has labels of so many code points.
inline constexpr std::size_t kPad = 32, kLabelCodes = 128;

enum Flag {
  position,
  direction,
  radiant,
  wavelength,
  luminous,
  stokes,
  tristimulus,
  spectrum_index,
  flag_count
};

enum SpectralId { no_spectrum, one_wavelength, wavelength_per_ray, one_table, table_per_ray };

inline constexpr std::array<std::string RaySetTexts::*, 9> kTextFields{
    &RaySetTexts::light_source,         &RaySetTexts::manufacturer,    &RaySetTexts::model_creator,
    &RaySetTexts::file_creator,         &RaySetTexts::equipment,       &RaySetTexts::camera,
    &RaySetTexts::operating_conditions, &RaySetTexts::additional_info, &RaySetTexts::geometry_reference};

constexpr std::uint64_t padded(std::uint64_t bytes) { return (bytes + kPad - 1) / kPad * kPad; }

}  // namespace lucerna::tm25
