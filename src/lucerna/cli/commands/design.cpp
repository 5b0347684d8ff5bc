// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <functional>
#include <utility>

#include "lucerna/cli/commands/commands.h"
#include "lucerna/cli/commands/design_lens.h"
#include "lucerna/cli/output/design_output.h"
#include "lucerna/cli/parse/arguments.h"
#include "lucerna/cli/parse/design_arguments.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/results/folders/design_files.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna::cli {

namespace {

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
  session.prepare_folder(a.output, session.force || a.resume);
  require_report(a.report);
  for (const std::string& warning : problem.project.warnings) session.note(warning);
  for (const auto& input : problem.project.inputs) session.add_input(input);
  DesignProgress start;
  if (a.resume) {
    start = read_design_progress(a.output);
    if (start.checkpoint.empty()) session.note(fmt::format("{}: no checkpoint yet, starting anew", a.output));
  }
  options.checkpoint = start.checkpoint;
  DesignWatch watch(a.output, problem, start.history, session);
  const DesignRun made = run_watched(problem, options, std::ref(watch), session, session.progress());
  exit_code = write_design_output(
      {a.output, a.report, options.seed, accelerator ? accelerator->name() : "cpu", watch.history()}, problem,
      made, session);
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
  add_design_options(command, *arguments, session, true);
  command.on_run([arguments, &session, &exit_code] { run_design_command(*arguments, session, exit_code); });
}

}  // namespace lucerna::cli
