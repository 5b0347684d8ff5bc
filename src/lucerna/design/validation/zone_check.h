// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "lucerna/design/problem/zone_cells.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/estimate.h"

namespace lucerna {

/// A cell is met or missed where it is more than so many standard errors on one side of a bound: Student's t
/// with 15 degrees of freedom passes 4 once in 1700 times.
inline constexpr double kZoneErrors = 4.0;

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
