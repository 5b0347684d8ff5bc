// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design_run.h"

#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/run/lens_run.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna {

namespace {

/// Rays that are set aside for the trace of the result and for the figures, in units of what a trace would
/// take by default.
constexpr std::uint64_t kFinalTraceRays = 8;

std::uint64_t rays_after(const DesignProblem& problem) {
  std::uint64_t rays = kFinalTraceRays * default_ray_count(problem.project.scene);
  if (problem.tolerances) {
    rays += problem.tolerances->rays * tolerance_cases(*problem.tolerances, 1).size();
  }
  return rays;
}

/// What users of the library get of it.
DesignedMirror designed_mirror(std::shared_ptr<const DesignRecord> record, TraceResult traced) {
  const DesignProblem& problem = record->problem;
  const DesignResult& result = record->result;
  DesignedMirror out{static_cast<const DesignFindings&>(result),
                     result.shape.reflector(),
                     problem.world_from_mirror,
                     project_text(with_shape(problem, result.shape)),
                     std::move(traced),
                     record->figures.trace,
                     record->figures.tolerances};
  for (const FitRecord& step : result.history) out.history.push_back(design_step(step));
  out.checkpoint = result.checkpoint;
  out.record = std::move(record);
  return out;
}

}  // namespace

std::shared_ptr<Accelerator> design_accelerator(TraceDevice device) {
  if (device == TraceDevice::cpu) return nullptr;
  auto found = cuda_accelerators();
  if (!found.empty()) return std::move(found.front());
  if (device == TraceDevice::cuda) require_cuda();
  return nullptr;
}

DesignRun run_design(const DesignProblem& problem, DesignOptions options, Progress& progress,
                     const DesignObserver& observer) {
  options.rays_after = rays_after(problem);
  double design_s = 0.0;
  DesignRun run(timed(design_s, [&] { return design(problem, options, progress, observer); }));
  run.design_s = design_s;
  const Scene scene = with_shape(problem, run.result.shape).scene;
  follow_up(problem.target, run.result.error.scale, scene, {.seed = options.seed + 1},
            final_goal(options.time_s.value_or(problem.time_s)), options.final_trace, progress, run);
  if (problem.tolerances) {
    unless_stopped(options, run.result, "tolerances", [&] {
      run.figures.tolerances = timed(run.tolerances_s, [&] {
        return tolerance_sweep(scene, *problem.tolerances, options.seed + 2, progress, options.peers);
      });
    });
  }
  return run;
}

DesignedMirror design(Project project, const std::string& name, const DesignSettings& settings,
                      Progress& progress, const DesignWatcher& watcher) {
  if (is_lens_design(project)) return designed_lens(std::move(project), name, settings, progress, watcher);
  DesignProblem problem = design_problem(std::move(project), name);
  if (settings.tolerances && !problem.tolerances) problem.tolerances = ToleranceRanges{};
  DesignOptions options;
  options.seed = settings.seed;
  options.time_s = settings.time_s;
  options.max_rays = settings.max_rays;
  options.validation_rays = 4 * settings.max_rays;
  options.accelerator = design_accelerator(settings.device);
  options.pareto = settings.pareto;
  options.advise = settings.advise;
  options.checkpoint = settings.checkpoint;
  DesignObserver observer;
  if (watcher) {
    observer = [&](const FitRecord& step, const DesignShape&, const std::string& checkpoint) {
      watcher(design_step(step), checkpoint);
    };
  }
  DesignRun run = run_design(problem, options, progress, observer);
  return designed_mirror(std::make_shared<const DesignRecord>(DesignRecord{
                             std::move(problem), std::move(run.result), std::move(run.figures), settings.seed,
                             options.accelerator ? options.accelerator->name() : "cpu"}),
                         std::move(run.trace.result));
}

DesignedMirror design(const std::filesystem::path& project, const DesignSettings& settings,
                      Progress& progress) {
  return design(read_project(project, progress), project.string(), settings, progress);
}

}  // namespace lucerna
