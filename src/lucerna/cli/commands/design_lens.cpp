// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/commands/design_lens.h"

#include <functional>
#include <nlohmann/json.hpp>
#include <utility>

#include "lucerna/cli/output/design_output.h"
#include "lucerna/design/run/lens_run.h"
#include "lucerna/results/folders/lens_files.h"

namespace lucerna::cli {

namespace {

/// Draws the progress and leaves the best so far in the folder after every step.
class LensWatch {
 public:
  LensWatch(std::filesystem::path folder, const LensProblem& problem, Session& session)
      : folder_(std::move(folder)), problem_(problem), session_(session) {}

  void operator()(const FitRecord& record, const ShapedLens& best) {
    add_step(record, history_);
    write_lens_progress(folder_, problem_, best, history_);
    session_.show(step_line(record));
  }
  const std::string& history() const { return history_; }

 private:
  std::filesystem::path folder_;
  const LensProblem& problem_;
  Session& session_;
  std::string history_;
};

}  // namespace

void design_lens_command(Project project, const std::string& name, const DesignSettings& settings,
                         const std::filesystem::path& folder, const std::string& report, Session& session,
                         int& exit_code) {
  check_lens_settings(settings);
  const LensProblem problem = lens_problem(std::move(project), name);
  session.prepare_folder(folder.string(), session.force);
  require_report(report);
  for (const std::string& warning : problem.project.warnings) session.note(warning);
  for (const auto& input : problem.project.inputs) session.add_input(input);
  LensWatch watch(folder, problem, session);
  const LensRun run = run_lens(problem, lens_options(settings), session.progress(), std::ref(watch));
  note_phases(run, session);
  const auto write = [&](const Json& json) {
    return write_lens_files(folder, problem, run.result, run.figures, run.trace.result, watch.history(),
                            json);
  };
  exit_code = write_design_output({folder.string(), report, settings.seed, "cpu", watch.history()},
                                  {problem.target, run.result, design_form(run.result), run, problem.project},
                                  write, session);
}

}  // namespace lucerna::cli
