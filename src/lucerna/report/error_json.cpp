// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report/error_json.h"

#include <cmath>

namespace lucerna {

namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }

}  // namespace

Json estimate_json(const Estimate& e) {
  return {{"value", number(e.mean)}, {"standard_error", number(e.standard_error)}};
}

Json estimate_json(const BoxErrorEstimate& e) {
  return {{"value", number(e.value)},
          {"floor", number(e.floor)},
          {"excess", number(e.excess)},
          {"standard_error", number(e.standard_error)}};
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
