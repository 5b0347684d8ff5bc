// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lucerna/results/folders/trace_origin.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {

/// Fills `folder` with what `trace` and `merge` leave: files by detector (trace_files.h), result.json, and
/// the raw sums that `merge` takes. `json` begins with run_json and gets the rest. Returns the names of the
/// files. `warnings` begins with those of the figures (trace_warnings), which result.json has; what a format
/// had to leave out is added to it.
std::vector<std::string> write_trace_results(const std::filesystem::path& folder, const TraceResult& result,
                                             const TraceOrigin& origin, const TraceMetrics& figures,
                                             nlohmann::ordered_json& json,
                                             std::vector<std::string>& warnings);

}  // namespace lucerna
