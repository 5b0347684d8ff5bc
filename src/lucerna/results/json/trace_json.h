// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "lucerna/photometric_metrics.h"
#include "lucerna/results/svg/svg_axes.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {

/// As estimate_json of error_json.h; null as a whole for a figure that is not determined.
nlohmann::ordered_json estimate_json(const std::optional<Estimate>& estimate);

/// Peak, centre and planes of a far field's metrics: what JSON results call `peak`, `centre`, `planes`.
nlohmann::ordered_json beam_json(const FarFieldMetrics& metrics);
/// The same of a distribution that is known exactly, without errors.
nlohmann::ordered_json beam_json(const BeamMetrics& beam);

/// `ledger` and `detectors` of result.json. What is not known is null.
nlohmann::ordered_json trace_json(const TraceMetrics& figures);

/// What diagrams write of a far field: of its entry in `detectors`.
DrawnFigures drawn_figures(const nlohmann::ordered_json& far_field);
DrawnFigures drawn_figures(const FarFieldResult& far_field);

}  // namespace lucerna
