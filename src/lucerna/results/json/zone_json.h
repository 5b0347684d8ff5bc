// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lucerna/design/validation/zone_check.h"
#include "lucerna/flux_unit.h"

namespace lucerna {

/// The zones of a target as found: an array, one object a zone.
nlohmann::ordered_json zones_json(const std::vector<ZoneCheck>& zones);

/// The same for people: the headline, then a line a bound. Empty without zones.
std::vector<std::string> zones_summary(const std::vector<ZoneCheck>& zones, FluxUnit unit);

}  // namespace lucerna
