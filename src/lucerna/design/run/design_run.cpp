// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design_run.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/run/lens_run.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna {

namespace {

/// The result is traced no longer than this share of the time (1 to 10 seconds); and as many rays are set
/// aside for it and for the figures, in units of what a trace would take by default.
constexpr double kFinalTraceShare = 0.1;
constexpr std::uint64_t kFinalTraceRays = 8;

std::uint64_t rays_after(const DesignProblem& problem) {
  std::uint64_t rays = kFinalTraceRays * default_ray_count(problem.project.scene);
  if (problem.tolerances) {
    rays += problem.tolerances->rays * tolerance_cases(*problem.tolerances, 1).size();
  }
  return rays;
}

/// What `work` returns; `seconds` gets how long it took.
template <class Work>
auto timed(double& seconds, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  auto made = work();
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

DesignStep design_step(const FitRecord& r) {
  return {r.evaluations, r.total_rays, r.error, r.floor, r.efficiency, r.in_rectangle, r.accepted};
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
  DesignRun run{timed(design_s, [&] { return design(problem, options, progress, observer); })};
  run.design_s = design_s;
  const Scene scene = with_shape(problem, run.result.shape).scene;
  NoiseGoal goal;
  goal.max_seconds = std::clamp(kFinalTraceShare * options.time_s.value_or(problem.time_s), 1.0, 10.0);
  run.noise_goal = goal.noise;
  const TraceOptions traced{.seed = options.seed + 1};
  run.trace = timed(run.trace_s, [&] {
    return options.final_trace ? options.final_trace(scene, traced, goal) : trace_until(scene, traced, goal);
  });
  run.figures = timed(run.figures_s, [&] {
    return design_metrics(problem.target, run.result.error.scale, run.trace.result, scene, progress);
  });
  if (problem.tolerances && run.result.end != DesignTermination::interrupted) {
    run.figures.tolerances = timed(run.tolerances_s, [&] {
      return tolerance_sweep(scene, *problem.tolerances, options.seed + 2, progress, options.peers);
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
