// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/design.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "lucerna/cli/arguments.h"
#include "lucerna/cli/commands.h"
#include "lucerna/core/error.h"
#include "lucerna/core/file.h"
#include "lucerna/report/design_files.h"
#include "lucerna/report/report_design.h"
#include "lucerna/trace.h"
#include "lucerna/trace/accelerator.h"

namespace lucerna::cli {

namespace {

namespace fs = std::filesystem;

/// The result is traced until its figures are good to 1 %, but no longer than this share of the time (1 to 10
/// seconds); and as many rays are set aside for it, in units of what a trace would take by default.
constexpr double kFinalTraceShare = 0.1;
constexpr std::uint64_t kFinalTraceRays = 4;

struct DesignArguments {
  std::string project, output, time, seed = "1", rays, device = "auto", report;
  bool resume = false, tolerances = false, pareto = false, advise = false;
};

/// Where evaluations are traced: the first CUDA device, or null for the CPU.
std::shared_ptr<Accelerator> chosen_accelerator(const std::string& name) {
  const TraceDevice device = trace_device(name);
  if (device == TraceDevice::cpu) return nullptr;
  auto found = cuda_accelerators();
  if (!found.empty()) return std::move(found.front());
  if (device == TraceDevice::cuda) throw InputError(fmt::format("--device cuda: {}", why_no_cuda()));
  return nullptr;
}

DesignOptions design_options(const DesignArguments& a, const DesignProblem& problem) {
  DesignOptions options;
  options.seed = parse_count(a.seed);
  options.pareto = a.pareto;
  options.advise = a.advise;
  if (!a.time.empty()) options.time_s = parse_number(a.time);
  if (!a.rays.empty()) {
    options.max_rays = parse_count(a.rays);
    options.judge_rays = 4 * options.max_rays;
  }
  options.rays_after = kFinalTraceRays * default_ray_count(problem.project.scene);
  if (problem.tolerances) {
    options.rays_after += problem.tolerances->rays * tolerance_cases(*problem.tolerances, 1).size();
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

DesignFigures finish(const DesignProblem& problem, const DesignResult& result, const DesignOptions& options,
                     TraceResult& traced, Session& session) {
  const Project project = with_shape(problem, result.shape);
  TraceOptions trace_options;
  trace_options.seed = options.seed + 1;
  NoiseGoal goal;
  goal.most_seconds = std::clamp(kFinalTraceShare * options.time_s.value_or(problem.time_s), 1.0, 10.0);
  NoiseTrace final_trace =
      session.timed("trace", [&] { return trace_until(project.scene, trace_options, goal); });
  if (final_trace.end == NoiseEnd::time) {
    session.note(fmt::format("the trace of the result has {:.2g} % noise, {:.2g} % wanted: {}",
                             100.0 * final_trace.noise, 100.0 * goal.noise, to_string(final_trace.end)));
  }
  traced = std::move(final_trace.result);
  DesignFigures figures = session.timed("figures", [&] { return design_figures(problem, result, traced); });
  if (problem.tolerances && result.end != DesignEnd::interrupted) {
    figures.tolerances = session.timed("tolerances", [&] {
      return tolerance_sweep(project.scene, *problem.tolerances, options.seed + 2, session.progress());
    });
  }
  return figures;
}

void run_design(const DesignArguments& a, Session& session, int& exit_code) {
  session.start();
  const auto accelerator = chosen_accelerator(a.device);
  DesignProblem problem = session.timed(
      "read", [&] { return design_problem(read_project(a.project, session.progress()), a.project); });
  if (a.tolerances && !problem.tolerances) problem.tolerances = ToleranceRanges{};
  DesignOptions options = design_options(a, problem);
  options.accelerator = accelerator;
  prepare_folder(a.output, session.force || a.resume);
  for (const std::string& warning : problem.project.warnings) session.note(warning);
  for (const auto& input : problem.project.inputs) session.add_input(input);
  DesignStart start;
  if (a.resume) {
    start = read_design_progress(a.output);
    if (start.checkpoint.empty()) session.note(fmt::format("{}: no checkpoint yet, starting anew", a.output));
  }
  options.checkpoint = start.checkpoint;
  DesignWatch watch(a.output, problem, start.history, session);
  const DesignResult result =
      session.timed("design", [&] { return design(problem, options, session.progress(), std::ref(watch)); });
  TraceResult traced;
  const DesignFigures figures = finish(problem, result, options, traced, session);
  Json json = session.json_head(options.seed, traced.isa);
  json["device"] = accelerator ? accelerator->name() : "cpu";
  json.update(design_json(problem, result, figures));
  json.update(trace_json(figures.trace));
  const auto names = session.timed("files", [&] {
    return write_design_files(a.output, problem, result, figures, traced, watch.history(), json);
  });
  session.print_json(json);
  session.say(fmt::format("{}: {} parameters, {} evaluations, {:.3g} M rays in {:.3g} s ({})", a.output,
                          result.shape.parameter_count(), result.evaluations,
                          1e-6 * static_cast<double>(result.rays), session.seconds("design"),
                          to_string(result.end)));
  for (const std::string& line : design_summary(problem, result, figures)) session.say(line);
  session.say(fmt::format("  written: {}", fmt::join(names, " ")));
  if (!a.report.empty()) {
    write_design_report(a.output, a.report);
    session.say(fmt::format("  report: {}", a.report));
  }
  for (const LimitCheck& c : result.limits) {
    if (!c.held) exit_code = 1;
  }
  for (const ZoneCheck& zone : result.zones) {
    if (zone.verdict() != ZoneVerdict::met) exit_code = 1;
  }
  if (result.end == DesignEnd::interrupted) exit_code = 3;
}

}  // namespace

void add_design(CLI::App& app, Session& session, int& exit_code) {
  Command command(app, "design", "Find the mirror that makes the project's target");
  auto arguments = std::make_shared<DesignArguments>();
  DesignArguments& a = *arguments;
  command.required("PROJECT", a.project, "Project file with [target] and [design]");
  command.required("-o,--output", a.output, "Folder for the results");
  command.option("--time", a.time, "Seconds after which to have stopped with the best so far");
  command.option("--rays", a.rays, "Rays of the finest evaluations (default 2^23); four times as many judge");
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
  command.on_run([arguments, &session, &exit_code] { run_design(*arguments, session, exit_code); });
}

}  // namespace lucerna::cli
