// SPDX-License-Identifier: Apache-2.0
#include "lucerna/report.h"

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/design/run/lens_run.h"
#include "lucerna/report/html/report_design.h"
#include "lucerna/report/html/report_trace.h"
#include "lucerna/report/html/write_model_report.h"
#include "lucerna/results/folders/design_files.h"
#include "lucerna/results/folders/lens_files.h"
#include "lucerna/results/folders/trace_results.h"
#include "lucerna/results/json/design_json.h"
#include "lucerna/results/json/model_json.h"
#include "lucerna/results/json/run_json.h"
#include "lucerna/results/metrics/trace_warnings.h"
#include "lucerna/source_model.h"

namespace lucerna {

namespace {

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return;
  throw InputError(fmt::format("{}: cannot make the folder: {}", folder.string(), error.message()),
                   ErrorCause::unwritable);
}

}  // namespace

std::vector<std::string> write_trace(const std::filesystem::path& folder, const Project& project,
                                     const TraceResult& result, std::vector<std::string>* warnings) {
  make_folder(folder);  // before the seconds that the figures take
  return write_trace(folder, project, result, trace_metrics(result, project.scene), warnings);
}

std::vector<std::string> write_trace(const std::filesystem::path& folder, const Project& given,
                                     const TraceResult& result, const TraceMetrics& figures,
                                     std::vector<std::string>* warnings) {
  make_folder(folder);
  const Project project = save_memory(given, folder);
  nlohmann::ordered_json json = run_json({.inputs = project.inputs}, result.seed, result.isa);
  std::vector<std::string> found = trace_warnings(figures, project.scene, project.warnings);
  auto names = write_trace_results(folder, result, trace_origin(project), figures, json, found);
  if (warnings != nullptr) warnings->insert(warnings->end(), found.begin(), found.end());
  return names;
}

namespace {

std::vector<std::string> write_lens(const std::filesystem::path& folder, const DesignedMirror& lens) {
  const LensRecord& record = *lens.lens_record;
  LensProblem problem = record.problem;
  problem.project = save_memory(problem.project, folder);
  nlohmann::ordered_json json = run_json({.inputs = problem.project.inputs}, record.seed, lens.traced.isa);
  json.update(finished_design_json("cpu", problem.target, record.result, design_form(record.result),
                                   record.figures, problem.project.scene, problem.project.warnings));
  return write_lens_files(folder, problem, record.result, record.figures, lens.traced,
                          history_csv(record.result.history), json);
}

}  // namespace

std::vector<std::string> write_design(const std::filesystem::path& folder, const DesignedMirror& mirror) {
  make_folder(folder);
  if (mirror.lens_record != nullptr) return write_lens(folder, mirror);
  const DesignRecord& record = *mirror.record;
  DesignProblem problem = record.problem;
  problem.project = save_memory(problem.project, folder);
  nlohmann::ordered_json json = run_json({.inputs = problem.project.inputs}, record.seed, mirror.traced.isa);
  json.update(finished_design_json(record.device, problem.target, record.result, design_form(record.result),
                                   record.figures, problem.project.scene, problem.project.warnings));
  return write_design_files(folder, problem, record.result, record.figures, mirror.traced,
                            history_csv(record.result.history), json);
}

void write_report(const std::filesystem::path& input, const std::filesystem::path& html,
                  const std::vector<std::filesystem::path>& ray_files, Progress& progress) {
  write_report(input, html, ray_files, RunRecord(), progress);
}

void write_report(const std::filesystem::path& input, const std::filesystem::path& html,
                  const std::vector<std::filesystem::path>& ray_files, RunRecord run, Progress& progress) {
  if (is_source_model(input)) {
    const auto model = load_source_model(input);
    run.inputs = ray_files;
    run.inputs.insert(run.inputs.begin(), input);
    nlohmann::ordered_json json = run_json(run, std::nullopt);
    json.update(model_json(*model, input));
    write_model_report(*model, input, ray_files, std::move(json), html, progress);
    return;
  }
  if (!ray_files.empty()) {
    throw UsageError(
        fmt::format("rays to compare with go with a source model, and {} is none", input.string()));
  }
  if (std::filesystem::exists(input) && !std::filesystem::is_directory(input)) {
    throw_input_error(input.string(), "",
                      "is neither a source model (.nfl) nor the folder of a trace or design");
  }
  if (is_design_folder(input)) {
    write_design_report(input, html);
  } else {
    write_trace_report(input, html);
  }
}

}  // namespace lucerna
