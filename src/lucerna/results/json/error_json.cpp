// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/json/error_json.h"

#include <cmath>

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

}  // namespace

Json number_json(double value) { return std::isfinite(value) ? Json(value) : Json(); }

Json number_json(const std::optional<double>& value) { return value ? number_json(*value) : Json(); }

Json estimate_json(const Estimate& e) {
  return {{"value", number_json(e.mean)}, {"standard_error", number_json(e.standard_error)}};
}

Json estimate_json(const BoxErrorEstimate& e) {
  return {{"value", number_json(e.value)},
          {"floor", number_json(e.floor)},
          {"excess", number_json(e.excess)},
          {"standard_error", number_json(e.standard_error)}};
}

Json error_json(const DesignError& e) {
  return {{"c12", estimate_json(e.c12)}, {"c24", estimate_json(e.c24)}, {"c48", estimate_json(e.c48)}};
}

Json outside_json(const DesignError& e) {
  return {{"share", estimate_json(e.outside_share)},
          {"direct", estimate_json(e.outside_direct)},
          {"error", estimate_json(e.outside)}};
}

}  // namespace lucerna
