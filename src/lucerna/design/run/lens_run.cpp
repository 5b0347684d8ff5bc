// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/lens_run.h"

#include <algorithm>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// Evaluations of a lens need fewer rays than those of a mirror, whose settings these are made of.
constexpr std::uint64_t kLensRayDivisor = 2;

}  // namespace

LensRun run_lens(const LensProblem& problem, LensOptions options, Progress& progress,
                 const LensObserver& observer) {
  const double time_s = options.time_s.value_or(problem.time_s);
  const NoiseGoal goal = final_goal(time_s);
  options.time_s = std::max(0.5 * time_s, time_s - goal.max_seconds);
  double design_s = 0.0;
  LensRun run(timed(design_s, [&] { return design_lens(problem, options, progress, observer); }));
  run.design_s = design_s;
  const Scene scene = with_lens(problem, run.result.lens).scene;
  follow_up(problem.target, run.result.error.scale, scene, {.seed = options.seed + 1}, goal, {}, progress,
            run);
  return run;
}

void check_lens_settings(const DesignSettings& settings) {
  const auto refuse = [](bool asked, const char* what, std::string_view option) {
    if (asked)
      throw InputError(fmt::format("{}: a lens is designed without", what), ErrorCause::unsupported, option);
  };
  refuse(!settings.checkpoint.empty(), "a checkpoint to resume from", "resume");
  refuse(settings.pareto, "the trade between error and light", "pareto");
  refuse(settings.advise, "advice on other outlines", "advise");
  refuse(settings.tolerances, "tolerances", "tolerances");
  refuse(settings.device == TraceDevice::cuda, "a CUDA device", "device");
}

LensOptions lens_options(const DesignSettings& settings) {
  LensOptions options;
  options.seed = settings.seed;
  options.time_s = settings.time_s;
  options.max_rays = std::max<std::uint64_t>(std::uint64_t{1} << 13, settings.max_rays / kLensRayDivisor);
  options.validation_rays = 2 * options.max_rays;
  return options;
}

DesignedMirror designed_lens(Project project, const std::string& name, const DesignSettings& settings,
                             Progress& progress, const DesignWatcher& watcher) {
  check_lens_settings(settings);
  LensProblem problem = lens_problem(std::move(project), name);
  LensObserver observer;
  if (watcher)
    observer = [&](const FitRecord& step, const ShapedLens&) { watcher(design_step(step), std::string()); };
  LensRun run = run_lens(problem, lens_options(settings), progress, observer);
  DesignedMirror out{static_cast<const DesignFindings&>(run.result),
                     {},
                     problem.world_from_lens,
                     project_text(with_lens(problem, run.result.lens)),
                     std::move(run.trace.result),
                     run.figures.trace,
                     std::nullopt};
  for (const FitRecord& step : run.result.history) out.history.push_back(design_step(step));
  out.lens = shaped_solid(problem, run.result.lens);
  out.lens_record = std::make_shared<const LensRecord>(
      LensRecord{std::move(problem), std::move(run.result), std::move(run.figures), settings.seed});
  return out;
}

}  // namespace lucerna
