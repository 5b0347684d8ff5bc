// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>

#include "lucerna/design/validation/box_error.h"

namespace lucerna {

/// Null where it is not finite, or not there.
nlohmann::ordered_json number_json(double value);
nlohmann::ordered_json number_json(const std::optional<double>& value);
/// {"value", "standard_error"}; null where it is not known.
nlohmann::ordered_json estimate_json(const Estimate& estimate);
/// {"value", "floor", "excess", "standard_error"}; null where the noise is not known.
nlohmann::ordered_json estimate_json(const BoxErrorEstimate& estimate);
/// {"c12", "c24", "c48"} of the above.
nlohmann::ordered_json error_json(const DesignError& error);
/// {"share", "direct", "error"}: the light outside the rectangle.
nlohmann::ordered_json outside_json(const DesignError& error);

}  // namespace lucerna
