// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/lens_run.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

constexpr double kTraceShare = 0.1;
/// Evaluations of a lens need fewer rays than those of a mirror, whose settings these are made of.
constexpr std::uint64_t kLensRayDivisor = 2;

template <class Work>
auto in_seconds(double& seconds, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  auto made = work();
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

DesignStep lens_step(const FitRecord& r) {
  return {r.evaluations, r.total_rays, r.error, r.floor, r.efficiency, r.in_rectangle, r.accepted};
}

}  // namespace

LensRun run_lens(const LensProblem& problem, LensOptions options, Progress& progress,
                 const LensObserver& observer) {
  const double time_s = options.time_s.value_or(problem.time_s);
  NoiseGoal goal;
  goal.max_seconds = std::clamp(kTraceShare * time_s, 1.0, 10.0);
  options.time_s = std::max(0.5 * time_s, time_s - goal.max_seconds);
  double design_s = 0.0;
  LensRun run{in_seconds(design_s, [&] { return design_lens(problem, options, progress, observer); })};
  run.design_s = design_s;
  const Scene scene = with_lens(problem, run.result.shape).scene;
  run.noise_goal = goal.noise;
  run.trace = in_seconds(run.trace_s, [&] { return trace_until(scene, {.seed = options.seed + 1}, goal); });
  run.figures = in_seconds(run.figures_s, [&] {
    return design_metrics(problem.target, run.result.error.scale, run.trace.result, scene, progress);
  });
  return run;
}

void check_lens_settings(const DesignSettings& settings) {
  const auto refuse = [](bool asked, const char* what) {
    if (asked) throw InputError(fmt::format("{}: a lens is designed without", what), ErrorCause::unsupported);
  };
  refuse(!settings.checkpoint.empty(), "a checkpoint to resume from");
  refuse(settings.pareto, "the trade between error and light");
  refuse(settings.advise, "advice on other outlines");
  refuse(settings.tolerances, "tolerances");
  refuse(settings.device == TraceDevice::cuda, "a CUDA device");
}

DesignedMirror designed_lens(Project project, const std::string& name, const DesignSettings& settings,
                             Progress& progress, const DesignWatcher& watcher) {
  check_lens_settings(settings);
  LensProblem problem = lens_problem(std::move(project), name);
  LensOptions options;
  options.seed = settings.seed;
  options.time_s = settings.time_s;
  options.max_rays = std::max<std::uint64_t>(std::uint64_t{1} << 13, settings.max_rays / kLensRayDivisor);
  options.validation_rays = 2 * options.max_rays;
  LensObserver observer;
  if (watcher)
    observer = [&](const FitRecord& step, const LensShape&) { watcher(lens_step(step), std::string()); };
  LensRun run = run_lens(problem, options, progress, observer);
  DesignedMirror out{static_cast<const DesignFindings&>(run.result),
                     {},
                     problem.world_from_lens,
                     project_text(with_lens(problem, run.result.shape)),
                     std::move(run.trace.result),
                     run.figures.trace,
                     std::nullopt};
  for (const FitRecord& step : run.result.history) out.history.push_back(lens_step(step));
  out.lens = with_outline(problem, run.result.shape);
  out.lens_record = std::make_shared<const LensRecord>(
      LensRecord{std::move(problem), std::move(run.result), std::move(run.figures), settings.seed});
  return out;
}

}  // namespace lucerna
