// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/commands/design_lens.h"
#include "lucerna/cli/output/trace_output.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/core/io/file.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/design/run/design_run.h"
#include "lucerna/report/html/report_design.h"
#include "lucerna/results/folders/design_files.h"
#include "lucerna/results/json/trace_json.h"
#include "lucerna/results/metrics/trace_warnings.h"
#include "lucerna/trace.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna::cli {

namespace {

namespace fs = std::filesystem;

struct DesignArguments {
  std::string project, output, time, seed = "1", rays, device = "auto", report;
  bool resume = false, tolerances = false, pareto = false, advise = false;
};

DesignOptions design_options(const DesignArguments& a) {
  DesignOptions options;
  options.seed = parse_count(a.seed);
  options.pareto = a.pareto;
  options.advise = a.advise;
  if (!a.time.empty()) {
    options.time_s = parse_number(a.time);
    if (!(*options.time_s > 0.0)) throw UsageError(fmt::format("--time {} is not > 0", a.time));
  }
  if (!a.rays.empty()) {
    options.max_rays = parse_count(a.rays);
    options.validation_rays = 4 * options.max_rays;
    check(options);
  }
  return options;
}

/// Draws the progress and leaves the best so far in the folder after every step.
class DesignWatch {
 public:
  DesignWatch(fs::path folder, const DesignProblem& problem, std::string history, Session& session)
      : folder_(std::move(folder)), problem_(problem), history_(std::move(history)), session_(session) {}

  void operator()(const FitRecord& record, const DesignShape& best, const std::string& checkpoint) {
    const std::string line = history_csv({record});
    const std::size_t header = line.find('\n') + 1;
    history_ += history_.empty() ? line : line.substr(header);
    write_design_progress(folder_, problem_, best, history_, checkpoint);
    session_.show(
        fmt::format("design: error {:.2f} %, noise {:.2f} %, efficiency {:.1f} %, {:.3g} M rays, {:.0f} s",
                    100.0 * record.error, 100.0 * record.floor, 100.0 * record.efficiency,
                    1e-6 * static_cast<double>(record.total_rays), seconds()));
  }
  const std::string& history() const { return history_; }

 private:
  double seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  fs::path folder_;
  const DesignProblem& problem_;
  std::string history_;
  Session& session_;
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

DesignRun run(const DesignProblem& problem, const DesignOptions& options, DesignWatch& watch,
              Session& session) {
  DesignRun made = run_design(problem, options, session.progress(), std::ref(watch));
  session.add_seconds("design", made.design_s);
  session.add_seconds("trace", made.trace_s);
  session.add_seconds("figures", made.figures_s);
  if (made.figures.tolerances) session.add_seconds("tolerances", made.tolerances_s);
  if (made.trace.end == NoiseEnd::time) {
    note_noise("trace of the result: ", made.trace, made.noise_goal, session);
  }
  return made;
}

/// What a lens takes of the options; it refuses those that it does not have.
DesignSettings lens_settings(const DesignArguments& a, const DesignOptions& options) {
  DesignSettings settings;
  settings.seed = options.seed;
  settings.time_s = options.time_s;
  settings.max_rays = options.max_rays;
  settings.device = trace_device(a.device);
  settings.tolerances = a.tolerances;
  settings.pareto = a.pareto;
  settings.advise = a.advise;
  if (a.resume) settings.checkpoint = "resume";
  return settings;
}

void design_mirror(const DesignArguments& a, Project project, DesignOptions options, Session& session,
                   int& exit_code) {
  const auto accelerator = design_accelerator(trace_device(a.device));
  DesignProblem problem =
      session.timed("read", [&] { return design_problem(std::move(project), a.project); });
  if (a.tolerances && !problem.tolerances) problem.tolerances = ToleranceRanges{};
  options.accelerator = accelerator;
  prepare_folder(a.output, session.force || a.resume);
  require_writable(a.report);
  for (const std::string& warning : problem.project.warnings) session.note(warning);
  for (const auto& input : problem.project.inputs) session.add_input(input);
  DesignProgress start;
  if (a.resume) {
    start = read_design_progress(a.output);
    if (start.checkpoint.empty()) session.note(fmt::format("{}: no checkpoint yet, starting anew", a.output));
  }
  options.checkpoint = start.checkpoint;
  DesignWatch watch(a.output, problem, start.history, session);
  const DesignRun made = run(problem, options, watch, session);
  const DesignResult& result = made.result;
  const TraceResult& traced = made.trace.result;
  const DesignMetrics& figures = made.figures;
  Json json = session.json_head(options.seed, traced.isa);
  json["device"] = accelerator ? accelerator->name() : "cpu";
  json.update(design_json(problem.target, result, design_form(result), figures));
  json.update(trace_json(figures.trace));
  const std::vector<std::string> warnings = trace_warnings(figures.trace, problem.project.scene);
  for (const std::string& warning : warnings) session.note(warning);
  json["warnings"] = warnings;
  const auto names = session.timed("files", [&] {
    return write_design_files(a.output, problem, result, figures, traced, watch.history(), json);
  });
  session.print_json(json);
  session.print_line(fmt::format("{}: {} parameters, {} evaluations, {:.3g} M rays in {:.3g} s ({})",
                                 a.output, result.shape.parameter_count(), result.evaluations,
                                 1e-6 * static_cast<double>(result.rays), session.seconds("design"),
                                 to_string(result.end)));
  for (const std::string& line : design_summary(problem.target, result, design_form(result), figures))
    session.print_line(line);
  session.print_line(fmt::format("  written: {}", fmt::join(names, " ")));
  if (!a.report.empty()) {
    write_design_report(a.output, a.report);
    session.print_line(fmt::format("  report: {}", a.report));
  }
  for (const LimitCheck& c : result.limits) {
    if (!c.held) exit_code = 1;
  }
  for (const ZoneCheck& zone : result.zones) {
    if (zone.verdict() != ZoneVerdict::met) exit_code = 1;
  }
  if (result.end == DesignTermination::interrupted) exit_code = 3;
}

void run_design_command(const DesignArguments& a, Session& session, int& exit_code) {
  session.start();
  const DesignOptions options = design_options(a);
  Project project = session.timed("read", [&] { return read_project(a.project, session.progress()); });
  if (is_lens_design(project)) {
    design_lens_command(std::move(project), a.project, lens_settings(a, options), a.output, a.report, session,
                        exit_code);
  } else {
    design_mirror(a, std::move(project), options, session, exit_code);
  }
}

}  // namespace

void add_design(CLI::App& app, Session& session, int& exit_code) {
  Command command(app, "design", "Find the mirror or lens that makes the project's target");
  auto arguments = std::make_shared<DesignArguments>();
  DesignArguments& a = *arguments;
  command.required("PROJECT", a.project, "Project file with [target] and [design]");
  command.required("-o,--output", a.output, "Folder for the results");
  command.option("--time", a.time, "Seconds after which to have stopped with the best so far");
  command.option("--rays", a.rays,
                 "Rays of the finest evaluations (default 2^23); four times as many validate");
  command.option("--seed", a.seed, "Seed of the random numbers");
  command.option("--device", a.device, "cpu, cuda or auto");
  command.option("--report", a.report, "Also write the report as one HTML file");
  command.flag("--tolerances", a.tolerances, "Try what a misplaced source and an inexact mirror change");
  command.flag("--pareto", a.pareto, "Also the trade between error and light (after the time)");
  command.flag("--advise", a.advise,
               "Also design it wider, with half the hole, as another family, ..., each for the same time");
  command.flag("--resume", a.resume, "Go on from the folder's checkpoint");
  command.flag("--force", session.force, "Write into a folder that is not empty");
  session.add_json(command);
  session.add_common(command);
  command.on_run([arguments, &session, &exit_code] { run_design_command(*arguments, session, exit_code); });
}

}  // namespace lucerna::cli
