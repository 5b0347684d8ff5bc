// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "lucerna/flux_unit.h"
#include "lucerna/project/schema/toml_reader.h"

namespace lucerna {

/// In which coordinates a zone is given.
enum class ZoneCoordinates {
  gamma_c,  ///< CIE Type C, degrees: row gamma, column C
  h_v,      ///< degrees about the target's axis: row v (up), column h (right, seen along the axis)
  plane     ///< mm on the target's plane: row y, column x
};

inline constexpr double kMm2PerM2 = 1e6;

/// An interval in degrees or mm; a point where both ends are the same.
struct ZoneRange {
  double low = 0.0, high = 0.0;
  double width() const { return high - low; }
  friend bool operator==(const ZoneRange&, const ZoneRange&) = default;
};

/// What a bound on a zone's light is a multiple of.
enum class ZoneReference {
  absolute,  ///< 1 cd, or 1 lx
  mean,      ///< the mean over a zone
  brightest  ///< the zone's own brightest measuring cell
};

/// No measuring cell of a zone darker (or brighter) than this.
struct ZoneBound {
  /// As in the project: "min_cd", "max_of_mean", "min_uo", ...
  std::string key;
  bool is_min = true;
  /// In cd or lx, or a multiple of the reference.
  double value = 0.0;
  ZoneReference reference = ZoneReference::absolute;
  /// The zone whose mean it is.
  std::size_t mean_of = 0;
};

/// A region of a target with bounds on its light: one line of a tolerance table.
struct TargetZone {
  std::string name;
  ZoneCoordinates coordinates = ZoneCoordinates::gamma_c;
  ZoneRange row, column;
  /// Side of the cells in which light is measured, degrees or mm.
  double cell = 1.0;
  std::vector<ZoneBound> bounds;

  bool asks_for_light() const;
  /// The first bound of that kind, or null.
  const ZoneBound* bound(bool is_min, ZoneReference reference) const;
};

/// Reads [[target.zone]]: `name`; the region as `gamma_deg` and `c_deg`, as `h_deg` and `v_deg`, or on a
/// plane as `x_mm` and `y_mm`, each a number or [low, high] (`c_deg` may pass 360); `cell_deg` or `cell_mm`;
/// and at least one bound: `min_cd`, `max_cd` or `min_cd_per_klm`, `max_cd_per_klm` (per 1000 lm of the
/// sources); on planes `min_lx`, `max_lx`, `min_uo` (minimum over mean) and `min_ul` (minimum over maximum
/// along a line); `min_of_mean`, `max_of_mean` with `mean_of`, the name of a zone. In W, cd represents W/sr
/// and lx for W/m2. Empty without zones. Throws InputError with file, line, key, found and expected.
std::vector<TargetZone> read_zones(TomlReader& target, bool plane, double source_flux);

}  // namespace lucerna
