// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/commands/design_lens.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/output/trace_output.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/run/design.h"
#include "lucerna/design/run/lens_run.h"
#include "lucerna/report/html/report_design.h"
#include "lucerna/results/folders/lens_files.h"
#include "lucerna/results/json/design_json.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/results/metrics/trace_warnings.h"

namespace lucerna::cli {

namespace {

/// Draws the progress and leaves the best so far in the folder after every step.
class LensWatch {
 public:
  LensWatch(std::filesystem::path folder, const LensProblem& problem, Session& session)
      : folder_(std::move(folder)), problem_(problem), session_(session) {}

  void operator()(const FitRecord& record, const LensShape& best) {
    const std::string line = history_csv({record});
    history_ += history_.empty() ? line : line.substr(line.find('\n') + 1);
    write_lens_progress(folder_, problem_, best, history_);
    session_.show(fmt::format("design: error {:.2f} %, noise {:.2f} %, efficiency {:.1f} %, {:.3g} M rays",
                              100.0 * record.error, 100.0 * record.floor, 100.0 * record.efficiency,
                              1e-6 * static_cast<double>(record.total_rays)));
  }
  const std::string& history() const { return history_; }

 private:
  std::filesystem::path folder_;
  const LensProblem& problem_;
  Session& session_;
  std::string history_;
};

void print_lens(const LensProblem& problem, const LensRun& run, const std::string& folder,
                const std::vector<std::string>& names, Session& session) {
  const LensResult& result = run.result;
  session.print_line(
      fmt::format("{}: a lens of {} parameters, {} evaluations, {:.3g} M rays in {:.3g} s ({})", folder,
                  result.shape.parameter_count(), result.evaluations, 1e-6 * static_cast<double>(result.rays),
                  session.seconds("design"), to_string(result.end)));
  for (const std::string& line : design_summary(problem.target, result, design_form(result), run.figures))
    session.print_line(line);
  session.print_line(fmt::format("  written: {}", fmt::join(names, " ")));
}

}  // namespace

void design_lens_command(Project project, const std::string& name, const DesignSettings& settings,
                         const std::filesystem::path& folder, const std::string& report, Session& session,
                         int& exit_code) {
  check_lens_settings(settings);
  const LensProblem problem = lens_problem(std::move(project), name);
  prepare_folder(folder.string(), session.force);
  require_writable(report);
  for (const std::string& warning : problem.project.warnings) session.note(warning);
  for (const auto& input : problem.project.inputs) session.add_input(input);
  LensWatch watch(folder, problem, session);
  const LensRun run = run_lens(problem, lens_options(settings), session.progress(), std::ref(watch));
  session.add_seconds("design", run.design_s);
  session.add_seconds("trace", run.trace_s);
  session.add_seconds("figures", run.figures_s);
  if (run.trace.end == NoiseEnd::time)
    note_noise("trace of the result: ", run.trace, run.noise_goal, session);
  Json json = session.json_head(settings.seed, run.trace.result.isa);
  json["device"] = "cpu";
  json.update(design_json(problem.target, run.result, design_form(run.result), run.figures));
  json.update(trace_json(run.figures.trace));
  const std::vector<std::string> warnings = trace_warnings(run.figures.trace);
  for (const std::string& warning : warnings) session.note(warning);
  json["warnings"] = warnings;
  const auto names = session.timed("files", [&] {
    return write_lens_files(folder, problem, run.result, run.figures, run.trace.result, watch.history(),
                            json);
  });
  session.print_json(json);
  print_lens(problem, run, folder.string(), names, session);
  if (!report.empty()) {
    write_design_report(folder, report);
    session.print_line(fmt::format("  report: {}", report));
  }
  for (const LimitCheck& c : run.result.limits) {
    if (!c.held) exit_code = 1;
  }
  if (run.result.end == DesignTermination::interrupted) exit_code = 3;
}

}  // namespace lucerna::cli
