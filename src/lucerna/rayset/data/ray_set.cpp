// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>

#include "lucerna/rays.h"

namespace lucerna {

std::string standard_label(ColumnKind kind, std::size_t n) {
  static constexpr std::array<const char*, 6> kStokes{"Stokes S1",      "Stokes S2",      "Stokes S3",
                                                      "ellipse axis x", "ellipse axis y", "ellipse axis z"};
  switch (kind) {
    case ColumnKind::radiant_flux_w:
      return "radiant flux W";
    case ColumnKind::luminous_flux_lm:
      return "luminous flux lm";
    case ColumnKind::wavelength_nm:
      return "wavelength nm";
    case ColumnKind::stokes:
      return kStokes[std::min(n, kStokes.size() - 1)];
    case ColumnKind::tristimulus_x:
      return "tristimulus X";
    case ColumnKind::tristimulus_z:
      return "tristimulus Z";
    case ColumnKind::spectrum_index:
      return "spectrum index";
    case ColumnKind::additional:
      return "";
  }
  return "";
}

std::optional<std::size_t> find_column(const std::vector<ColumnSpec>& columns, ColumnKind kind) {
  const auto found = std::ranges::find(columns, kind, &ColumnSpec::kind);
  if (found == columns.end()) return std::nullopt;
  return static_cast<std::size_t>(found - columns.begin());
}

}  // namespace lucerna
