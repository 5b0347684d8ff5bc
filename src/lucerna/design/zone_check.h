// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lucerna/design/box_error.h"
#include "lucerna/design/zone_cells.h"
#include "lucerna/estimate.h"

namespace lucerna {

/// Whether a bound is kept: decided only where the noise leaves no doubt.
enum class ZoneVerdict { met, missed, undetermined };
std::string_view to_string(ZoneVerdict verdict);

/// A cell is met or missed where it is more than so many standard errors on one side of a bound: Student's t
/// with 15 degrees of freedom passes 4 once in 1700 times.
inline constexpr double kZoneErrors = 4.0;

/// One bound of a zone against the light that was found.
struct ZoneBoundCheck {
  std::string key;
  bool is_min = true;
  /// In cd or lx, or a multiple of the bound's reference, which `reference` is (1 for absolute bounds).
  double allowed = 0.0;
  double reference = 1.0;
  /// Of the cell that comes nearest to breaking it, in the same unit as `allowed`.
  Estimate found;
  std::string place;
  /// What that cell is short of the bound (or above it), over the bound; negative: so much is to spare.
  double missing = 0.0;
  ZoneVerdict verdict = ZoneVerdict::met;
};

/// A zone's light, by its measuring cells, in cd or lx.
struct ZoneCheck {
  std::string name;
  std::size_t cells = 0;
  /// Side of the cells, degrees or mm.
  double cell = 1.0;
  bool on_plane = false;
  /// Darkest and brightest cell, with their own errors; noise spreads the two. And the mean over the zone.
  Estimate min, max, mean;
  std::vector<ZoneBoundCheck> bounds;

  /// Missed where any bound is, else undetermined where any is.
  ZoneVerdict verdict() const;
};

/// Zones against the light of `replicates` (BoxSums::zones), at least two.
std::vector<ZoneCheck> check_zones(const ZoneCells& cells, std::span<const BoxSums> replicates,
                                   double source_flux);

/// The largest `missing` of each zone's bounds, where it is above 0, summed: 0 where all are met.
double missing_in_zones(std::span<const ZoneCheck> zones);

/// Whether any zone's verdict is open.
bool any_undetermined(std::span<const ZoneCheck> zones);

/// "5 of 6 zones met; missed: centre (min_cd: 148 +- 1 found at h 0, v 5 deg, 150 allowed)".
std::string zones_headline(std::span<const ZoneCheck> zones);

}  // namespace lucerna
