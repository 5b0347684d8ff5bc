// SPDX-License-Identifier: Apache-2.0
#include "lucerna/results/folders/trace_results.h"

#include <nlohmann/json.hpp>

#include "lucerna/results/folders/trace_file.h"
#include "lucerna/results/folders/trace_files.h"
#include "lucerna/results/json/trace_json.h"

namespace lucerna {

std::vector<std::string> write_trace_results(const std::filesystem::path& folder, const TraceResult& result,
                                             const TraceOrigin& origin, const TraceMetrics& figures,
                                             nlohmann::ordered_json& json,
                                             std::vector<std::string>& warnings) {
  json["sequence"] = std::string(to_string(result.sequence));
  json["rays"] = {{"first", result.first_ray}, {"last", result.last_ray}};
  json.update(trace_json(figures));
  json["warnings"] = warnings;
  write_trace_file(folder / kTraceFileName, result, origin);
  auto names = write_trace_files(folder, origin, figures, result.out_rays, json, &warnings);
  names.insert(names.end() - 2, kTraceFileName);
  return names;
}

}  // namespace lucerna
