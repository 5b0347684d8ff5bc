// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include "lucerna/core/error.h"

/// Zemax's code for lengths, the same in its binary and text files.
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

}  // namespace lucerna::zemax
