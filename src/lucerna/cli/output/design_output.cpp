// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/design_output.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/output/trace_output.h"
#include "lucerna/report/html/report_design.h"
#include "lucerna/results/folders/design_files.h"

namespace lucerna::cli {

void add_step(const FitRecord& record, std::string& history) {
  const std::string line = history_csv({record});
  const std::size_t header = line.find('\n') + 1;
  history += history.empty() ? line : line.substr(header);
}

std::string step_line(const FitRecord& record) {
  return fmt::format("design: error {:.2f} %, noise {:.2f} %, efficiency {:.1f} %, {:.3g} M rays",
                     100.0 * record.error, 100.0 * record.floor, 100.0 * record.efficiency,
                     1e-6 * static_cast<double>(record.total_rays));
}

void note_phases(const FollowUp& run, Session& session) {
  session.add_seconds("design", run.design_s);
  session.add_seconds("trace", run.trace_s);
  session.add_seconds("figures", run.figures_s);
  if (run.figures.tolerances) session.add_seconds("tolerances", run.tolerances_s);
  if (run.trace.end == NoiseEnd::time && !session.progress().stop_requested())
    note_noise("trace of the result, for a tenth of the time and 10 s at most: ", run.trace, run.noise_goal,
               session);
}

void DesignWatch::operator()(const FitRecord& record, const DesignShape& best,
                             const std::string& checkpoint) {
  add_step(record, history_);
  write_design_progress(folder_, problem_, best, history_, checkpoint);
  session_.show(fmt::format("{}, {:.0f} s", step_line(record), seconds()));
}

DesignRun run_watched(const DesignProblem& problem, const DesignOptions& options, const DesignObserver& watch,
                      Session& session, Progress& progress) {
  DesignRun made = run_design(problem, options, progress, watch);
  note_phases(made, session);
  return made;
}

int write_design_output(const DesignOutput& output, const FinishedDesign& design, const DesignFiles& write,
                        Session& session) {
  const DesignFindings& result = design.result;
  const DesignMetrics& figures = design.run.figures;
  Json json = session.json_head(output.seed, design.run.trace.result.isa);
  json.update(finished_design_json(output.device, design.target, result, design.form, figures,
                                   design.project.scene, design.project.warnings));
  for (const auto& warning : json["warnings"]) session.note(warning.get<std::string>());
  session.print_json(json);
  session.print_line(
      fmt::format("{}: {}{} parameters, {} evaluations, {:.3g} M rays in {:.3g} s ({})", output.folder,
                  design.form.is_lens ? "a lens of " : "", design.form.parameters, result.evaluations,
                  1e-6 * static_cast<double>(result.rays), session.seconds("design"), to_string(result.end)));
  for (const std::string& line : design_summary(design.target, result, design.form, figures))
    session.print_line(line);
  // Last: a full disk must not hide what was found.
  session.print_line(fmt::format("  written: {}", fmt::join(write(json), " ")));
  if (!output.report.empty()) {
    write_design_report(output.folder, output.report);
    session.print_line(fmt::format("  report: {}", output.report));
  }
  int exit_code = 0;
  for (const LimitCheck& c : result.limits) {
    if (!c.held) exit_code = 1;
  }
  for (const ZoneCheck& zone : result.zones) {
    if (zone.verdict() != ZoneVerdict::met) exit_code = 1;
  }
  if (session.progress().stop_requested()) {
    exit_code = 3;
    // Asked to stop after the search: nothing is missing but finer figures of the final trace.
    if (result.end != DesignTermination::interrupted) note_interrupted_figures(session);
  }
  return exit_code;
}

int write_design_output(const DesignOutput& output, const DesignProblem& problem, const DesignRun& made,
                        Session& session) {
  const auto write = [&](const Json& json) {
    return write_design_files(output.folder, problem, made.result, made.figures, made.trace.result,
                              output.history, json);
  };
  return write_design_output(
      output, {problem.target, made.result, design_form(made.result), made, problem.project}, write, session);
}

}  // namespace lucerna::cli
