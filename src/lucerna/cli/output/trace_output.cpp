// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/trace_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/results/folders/trace_results.h"

namespace lucerna::cli {

std::vector<std::string> write_trace_output(const std::string& folder, const TraceResult& result,
                                            const TraceOrigin& origin, const TraceMetrics& figures,
                                            Session& session) {
  Json json = session.json_head(result.seed, result.isa);
  std::vector<std::string> warnings;
  auto names = write_trace_results(folder, result, origin, figures, json, warnings);
  for (const std::string& warning : warnings) session.note(warning);
  session.print_json(json);
  return names;
}

void print_trace_summary(const TraceMetrics& figures, const std::vector<std::string>& names,
                         Session& session) {
  for (const std::string& line : trace_summary(figures)) session.print_line(line);
  session.print_line(fmt::format("  written: {}", fmt::join(names, " ")));
}

}  // namespace lucerna::cli
