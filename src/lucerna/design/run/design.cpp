// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/core/io/sha256.h"
#include "lucerna/design/constraints/light_limits.h"
#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/constraints/source_side.h"
#include "lucerna/design/evaluation/body_shadows.h"
#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/approach.h"
#include "lucerna/design/run/result_check.h"
#include "lucerna/design/run/search_mirror.h"
#include "lucerna/design/run/time_budget.h"
#include "lucerna/project/schema/project_tables.h"
#include "lucerna/project/sections/project_content.h"
#include "lucerna/trace/device/accelerator.h"

namespace lucerna {

namespace {

constexpr double kNoLimit = std::numeric_limits<double>::infinity();
/// Rays that validate the result of a search that was interrupted.
constexpr std::uint64_t kMinValidationRays = std::uint64_t{1} << 18;
/// Share of a design's time that is set aside for the validation of its result.
constexpr double kMaxValidationShare = 0.1;
/// Rays that measure how much light leaves the mirror to begin with.
constexpr std::uint64_t kFluxRays = std::uint64_t{1} << 16;

/// Limits on the form and on the light, and that no mirror passes the source. `rays` must outlive `fit`.
void set_limits(const DesignProblem& problem, const DesignRays& rays, FitProblem& fit) {
  const ShapeLimits form(problem.limits, problem.start);
  const LightLimits light(problem.limits, problem.reflectance);
  if (!form.empty() || !light.empty()) {
    fit.limits = [form, light, &rays](const DesignShape& shape, std::uint64_t n, ResidualRows* rows) {
      return form.cost(shape, rows) + light.cost(shape, rays, n, rows);
    };
  }
  const auto side = std::make_shared<const SourceSide>(problem.start, rays);
  fit.in_front = [side](const DesignShape& shape, ResidualRows* rows) { return side->cost(shape, rows); };
  fit.within = [side](const DesignShape& shape) { return side->within(shape); };
  if (ShapeLimits both(problem.limits, problem.start, side->bounds()); !both.empty())
    fit.form = std::make_shared<const ShapeLimits>(std::move(both));
}

/// Tells checkpoints of different problems apart, also where a file behind a name has changed.
std::string problem_key(const DesignProblem& problem, const DesignOptions& options) {
  toml::table table = toml_tables(problem.project);
  if (auto* design = table["design"].as_table()) {
    design->erase("time_s");
    design->erase("tolerances");  // a sweep after the fit
  }
  std::ostringstream text;
  text << content_tables(std::move(table), problem.project.memory) << options.seed << ' ' << options.max_rays;
  // Sums on a device are rounded otherwise: taken up elsewhere, a design would not end at the same bits.
  if (options.accelerator) text << ' ' << options.accelerator->isa();
  return sha256_of_text(text.str()).substr(0, 16);
}

/// Validates what a search came to, by fewer rays and a shorter time where that was over first.
void check_result(const FitProblem& fit, const DesignOptions& options, const TimeBudget& time,
                  ResultCheck& check, DesignResult& result, Progress& progress) {
  std::uint64_t rays = options.validation_rays;
  double max_s = kNoLimit;
  if (result.end == DesignTermination::interrupted) rays = std::min(rays, kMinValidationRays);
  // The first round of rays it takes anyway.
  if (result.end == DesignTermination::time)
    max_s = of_first(options.peers, time.left_s() - time.rays_after_s());
  check.fill(fit, rays, max_s, result, progress);
}

}  // namespace

DesignRays design_rays(const DesignProblem& problem, const DesignOptions& options, std::uint64_t seed) {
  const Frame mirror_from_world = problem.world_from_mirror.inverse();
  DesignRays rays(problem.project.scene.sources, mirror_from_world, seed);
  rays.evaluate_on(options.accelerator);
  rays.shade_by(shadows_of(problem.project.scene, mirror_from_world));
  rays.share_with(options.peers);
  return rays;
}

FitProblem fit_problem(const DesignProblem& problem, const DesignOptions& options, DesignRays& rays) {
  FitProblem fit{&rays, problem.reflectance, {}, target_window(problem), problem.target.mode};
  fit.seed = options.seed;
  fit.max_failed_restarts = problem.max_failed_restarts;
  rays.grow(kFluxRays);
  if (problem.target.mode == TargetMode::shape) {
    EvaluationOptions plain;
    plain.rays = kFluxRays;
    plain.derivatives = false;
    const Evaluation start = evaluate(problem.start, problem.reflectance, rays, fit.bins, plain);
    fit.flux_weight = uses_free_form_search(problem) ? problem.light_weight : kFitFluxWeight;
    fit.flux_reference = start.reflected + start.direct;
  }
  LightLimits(problem.limits, problem.reflectance).check(problem.start, rays);
  set_limits(problem, rays, fit);
  fit.target = target_flux(problem.target, problem.world_from_mirror, rays.flux());
  fit.rectangle = target_rectangle(problem.target);
  fit.mirror_from_world = problem.world_from_mirror.inverse();
  fit.zones = {problem.target.zones, rays.flux(), fit.mirror_from_world, problem.target.zones_only};
  return fit;
}

void check(const DesignOptions& options) {
  constexpr std::uint64_t kFewest = kDesignTasks * kBlockRays;
  if (options.max_rays >= kFewest) return;
  throw InputError(
      fmt::format("{} rays of an evaluation asked for, expected at least {}", options.max_rays, kFewest),
      ErrorCause::out_of_range, "rays");
}

DesignResult design(const DesignProblem& problem, const DesignOptions& options, Progress& progress,
                    const DesignObserver& observer) {
  check(options);
  if (options.pareto) check_pareto(problem);
  LUCERNA_CHECK(options.peers == nullptr || !options.accelerator, "a device is not shared with peers");
  const double time_s = options.time_s.value_or(problem.time_s);
  TimeBudget time(time_s, options.peers);
  DesignRays rays = design_rays(problem, options, options.seed);
  FitProblem fit = fit_problem(problem, options, rays);
  ResultCheck result_check(problem, options, progress);
  time.begin_search(std::min(result_check.seconds(options.validation_rays), kMaxValidationShare * time_s),
                    options.rays_after);
  DesignResult result(problem.start);
  search_mirror({problem, options, problem_key(problem, options), time, progress, observer}, fit, result);
  result.shape = ShapeLimits(problem.limits, problem.start).nearest(result.shape);
  check_result(fit, options, time, result_check, result, progress);
  if (options.pareto) {
    unless_stopped(options, result, "the trade between error and light",
                   [&] { result.pareto = pareto_front(problem, result.shape, options, progress); });
  }
  if (options.advise) {
    unless_stopped(options, result, "what other mirrors would bring",
                   [&] { result.advice = advise(problem, result.error, options, progress); });
  }
  return result;
}

std::string_view to_string(DesignTermination end) {
  switch (end) {
    case DesignTermination::converged:
      return "converged";
    case DesignTermination::time:
      return "time";
    case DesignTermination::interrupted:
      return "interrupted";
  }
  return "";
}

std::string history_csv(const std::vector<FitRecord>& history) {
  std::string csv =
      "evaluations,candidate,stage,step,rays,total_rays,relative_rms,floor,lambda,accepted,efficiency,in_"
      "rectangle\n";
  for (const FitRecord& r : history) {
    csv += fmt::format("{},{},{},{},{},{},{:.6g},{:.6g},{:.3g},{},{:.6g},{:.6g}\n", r.evaluations,
                       r.candidate, r.stage, r.step, r.rays, r.total_rays, r.error, r.floor, r.lambda,
                       r.accepted ? 1 : 0, r.efficiency, r.in_rectangle);
  }
  return csv;
}

}  // namespace lucerna
