// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lucerna/design/design.h"
#include "lucerna/report/report_parts.h"

namespace lucerna {

/// The zones of a target as found: an array, one object a zone.
nlohmann::ordered_json zones_json(const std::vector<ZoneCheck>& zones);

/// The same for people: the headline, then a line a bound. Empty without zones.
std::vector<std::string> zones_summary(const std::vector<ZoneCheck>& zones, FluxUnit unit);

/// result.json's zones as a table; empty if it has none.
std::string zones_html(const ResultFigures& result);

}  // namespace lucerna
