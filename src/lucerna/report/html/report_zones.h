// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/estimate.h"
#include "lucerna/results/folders/trace_folder.h"

namespace lucerna {

/// Flux between two gammas.
struct Zone {
  double from_deg = 0.0, to_deg = 0.0;
  Estimate flux;
};

/// Flux of the zone [from, to] by `zonal_flux`; its standard error takes the cells as independent, NaN where
/// the cells' errors are not known. O(values).
Zone zone(const FarFieldTable& table, double from_deg, double to_deg);

/// Every 10 degrees from 0 to 180.
std::vector<Zone> ten_degree_zones(const FarFieldTable& table);

/// The sums that the trade quotes: 0-30, 0-40, 0-60, 60-90, 0-90, 90-180.
std::vector<Zone> summed_zones(const FarFieldTable& table);

/// CIE flux code (CIE 52): 100 times the shares N1, N2, N3 of the lower hemisphere's flux in the cones
/// of 41.4, 60 and 75.5 degrees, N4 = lower hemisphere over all, N5 = light output ratio, rounded, with
/// spaces; empty where no light goes down.
std::string cie_flux_code(const FarFieldTable& table, double light_output_ratio);

}  // namespace lucerna
