// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report.h"

#include <nlohmann/json.hpp>

#include "lucerna/core/error.h"
#include "lucerna/report/report_design.h"
#include "lucerna/report/report_trace.h"
#include "lucerna/report/run_json.h"
#include "lucerna/report/trace_results.h"

namespace lucerna {

std::vector<std::string> write_trace(const std::filesystem::path& folder, const Project& project,
                                     const TraceResult& result, std::vector<std::string>* warnings) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw_input_error(folder.string(), "", "cannot make the folder: {}", error.message());
  nlohmann::ordered_json json = run_json({.inputs = project.inputs}, result.seed, result.isa);
  std::vector<std::string> lost;
  return write_trace_results(folder, result, trace_origin(project), trace_figures(result, project.scene), json,
                             warnings != nullptr ? *warnings : lost);
}

void write_report(const std::filesystem::path& folder, const std::filesystem::path& html) {
  if (std::filesystem::exists(folder) && !std::filesystem::is_directory(folder)) {
    throw_input_error(folder.string(), "", "is a file, expected the folder of a trace or a design");
  }
  if (is_design_folder(folder)) {
    write_design_report(folder, html);
  } else {
    write_trace_report(folder, html);
  }
}

}  // namespace lucerna
