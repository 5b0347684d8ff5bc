// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>

#include "lucerna/held_out.h"
#include "lucerna/ray_comparison.h"

namespace lucerna {

/// `views`: "error", "floor", "excess", "standard_error" and "raw" of all five by name; null where not
/// finite.
nlohmann::ordered_json views_json(const RaySetComparison& comparison);
/// `held_out`: the views, and `scales` with the same of each and "cell_mm".
nlohmann::ordered_json held_out_json(const HeldOutComparison& found);

}  // namespace lucerna
