// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/design.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

#include "lucerna/core/error.h"
#include "lucerna/design/light_limits.h"
#include "lucerna/design/limits.h"
#include "lucerna/design/reach.h"
#include "lucerna/design/search_mirror.h"
#include "lucerna/design/time_budget.h"
#include "lucerna/design/window.h"
#include "lucerna/reflector/cad_export.h"
#include "lucerna/trace/accelerator.h"

namespace lucerna {

namespace {

/// In shape mode a tenth of the light beside the window counts as an error of 4.5 %.
constexpr double kFluxWeight = 0.2;
/// Of free forms, whose search has starts that catch the light: a tenth of it beside the rectangle counts as
/// an error of 1 %.
constexpr double kFluxWeightOfSearch = 0.01;
/// Rays that judge a result for which there is no time left.
constexpr std::uint64_t kFewestJudgeRays = std::uint64_t{1} << 18;
/// Rays that measure how much light leaves the mirror to begin with.
constexpr std::uint64_t kFluxRays = std::uint64_t{1} << 16;

/// Share of the rays (of the first that are enough to tell) that begin behind a mirror.
double share_behind(const DesignShape& shape, const DesignRays& rays) {
  constexpr std::uint64_t kBlocks = 16;
  double behind = 0.0, all = 0.0;
  for (std::uint64_t b = 0; b < std::min(kBlocks, rays.size() / kBlockRays); ++b) {
    const DesignRays::Block& block = rays.block(b);
    for (std::size_t i = 0; i < kBlockRays; ++i) {
      const auto x = static_cast<double>(block.x_mm[i]), y = static_cast<double>(block.y_mm[i]);
      const auto weight = static_cast<double>(block.weight[i]);
      all += weight;
      const bool over = shape.aperture().contains(x, y);
      if (over && static_cast<double>(block.z_mm[i]) < shape.at(x, y).z_mm) behind += weight;
    }
  }
  return behind / all;
}

/// What of the source may be behind a mirror beyond what the given mirror leaves there.
constexpr double kMostBehind = 1e-3;

/// All limits as one cost; empty without any. `rays` must outlive it.
std::function<double(const DesignShape&, std::uint64_t, ResidualRows*)> limits_cost(
    const DesignProblem& problem, const DesignRays& rays) {
  const ShapeLimits form(problem.limits, problem.start);
  const LightLimits light(problem.limits, problem.reflectance);
  if (form.empty() && light.empty()) return {};
  // The source is a body too: a limit must not be met by a mirror that has passed it.
  const double given = share_behind(problem.start, rays);
  return [form, light, given, &rays](const DesignShape& shape, std::uint64_t n, ResidualRows* rows) {
    const double past = std::max(0.0, share_behind(shape, rays) - given) / kMostBehind;
    return form.cost(shape, rows) + light.cost(shape, rays, n, rows) + past * past;
  };
}

/// FNV-1a: tells checkpoints of different problems apart.
std::string problem_key(const DesignProblem& problem, const DesignOptions& options) {
  toml::table table = problem.project.table;
  if (auto* design = table["design"].as_table()) {
    design->erase("time_s");
    design->erase("tolerances");  // a sweep after the fit
  }
  std::ostringstream text;
  text << table << options.seed << ' ' << options.max_rays;
  // Sums on a device are rounded otherwise: taken up elsewhere, a design would not end at the same bits.
  if (options.accelerator) text << ' ' << options.accelerator->isa();
  std::uint64_t hash = 0xcbf29ce484222325ull;
  for (const char c : text.str()) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ull;
  return fmt::format("{:016x}", hash);
}

/// Angular radius under which the mirror's vertex and rim see the source: what no mirror can sharpen.
double source_blur_rad(const DesignRays& rays, const DesignShape& shape) {
  const RayBlock some = rays.first(std::uint64_t{16} * kBlockRays);
  const auto n = static_cast<double>(some.size());
  Vec3 mean;
  for (std::size_t i = 0; i < some.size(); ++i) mean += some.origin_mm(i) / n;
  double square = 0.0;
  for (std::size_t i = 0; i < some.size(); ++i) {
    const Vec3 off = some.origin_mm(i) - mean;
    square += dot(off, off) / n;
  }
  const double rim = shape.aperture().half_x_mm(), z = shape.at(rim, 0.0).z_mm - mean.z;
  return std::atan2(std::sqrt(square), std::max(std::hypot(rim, z), std::abs(shape.at(0, 0).z_mm - mean.z)));
}

void add_remarks(const DesignRays& rays, DesignResult& result) {
  const double error = result.error.relative_rms, floor = result.error.floor;
  if (error <= 1.5 * floor) {
    result.remarks.push_back(fmt::format(
        "the noise floor is reached: {:.2f} % is left over, of which {:.2f} % is the noise of the "
        "judging rays; only more rays could show more",
        100.0 * error, 100.0 * floor));
  }
  if (error > 3.0 * floor && error > 0.02) {
    result.remarks.push_back(
        fmt::format("the target is not reached: {:.1f} % of it is left over, {:.1f} % would be noise; seen "
                    "from the rim the "
                    "source is {:.2f} deg in radius (rms), structure finer than that cannot be made",
                    100.0 * error, 100.0 * floor, degrees(source_blur_rad(rays, result.shape))));
  }
  if (result.in_window < 0.95 * result.efficiency) {
    result.remarks.push_back(
        fmt::format("{:.1f} % of the light that leaves goes beside the target's window: {}",
                    100.0 * (1.0 - result.in_window / result.efficiency),
                    "direct light passes the mirror; a wider or deeper mirror would catch it"));
  }
  // Where only noise is left, nothing holds the design back.
  const std::string binding = binding_limits(result.limits);
  if (error > 1.5 * floor && !binding.empty()) result.remarks.push_back(binding);
  for (const LimitCheck& c : result.limits) {
    if (c.held) continue;
    result.remarks.push_back(
        fmt::format("limit {} is not held: {:.4g} found, {:.4g} allowed", c.limit, c.found, c.allowed));
  }
}

/// All limits that are set, against the exported mesh and the judging light.
std::vector<LimitCheck> checked_limits(const DesignProblem& problem, const DesignShape& shape,
                                       const DesignRays& rays, std::uint64_t n) {
  std::vector<LimitCheck> out;
  const DesignLimits& limits = problem.limits;
  if (limits.any_on_form()) {
    const CadTolerance tolerance;
    out =
        check_limits(cad_mesh(shape.reflector(), tolerance), limits, tolerance.chord_mm, tolerance.slope_deg);
  }
  const LightLimits light(limits, problem.reflectance);
  if (light.empty()) return out;
  const LightLimits::Measured found = light.measure(shape, rays, n);
  if (limits.glare) {
    const double most = limits.glare->max_per_flux * rays.flux(), has = found.glare_per_flux * rays.flux();
    out.push_back({"glare " + limits.glare->text, most, has, has <= most});
  }
  if (limits.min_efficiency) {
    out.push_back({"min_efficiency", *limits.min_efficiency, found.efficiency,
                   found.efficiency >= *limits.min_efficiency});
  }
  return out;
}

void judge(const DesignProblem& problem, const DesignOptions& options, const FitProblem& fit,
           std::uint64_t judge_rays, DesignResult& result, Progress& progress) {
  DesignRays rays(problem.project.scene.sources, problem.world_from_mirror.inverse(),
                  options.seed + 0x9E3779B97F4A7C15ull);
  rays.evaluate_on(options.accelerator);
  rays.grow(judge_rays, progress);
  EvaluationOptions plain;
  plain.rays = judge_rays;
  plain.derivatives = false;
  const Eigen::VectorXd target = fit.target(fit.bins);
  const Evaluation e = evaluate(result.shape, problem.reflectance, rays, fit.bins, plain);
  result.error = bin_error(e, target, fit.bins, fit.mode);
  plain.rays = std::min<std::uint64_t>(plain.rays, 1 << 18);
  const Evaluation start = evaluate(problem.start, problem.reflectance, rays, fit.bins, plain);
  result.start_error = bin_error(start, target, fit.bins, fit.mode);
  result.efficiency = e.reflected + e.direct;
  result.in_window = e.flux.sum();
  result.absorbed = e.absorbed;
  result.back = e.back;
  result.lost = e.lost;
  result.limits = checked_limits(problem, result.shape, rays, judge_rays);
  const double behind = share_behind(result.shape, rays), given = share_behind(problem.start, rays);
  if (behind > given + kMostBehind) {
    result.limits.push_back({"source in front of the mirror (share behind it)", given, behind, false});
  }
  result.remarks = target_reach(rays, problem.start, fit.bins, target, fit.mode,
                                problem.limits.min_efficiency.value_or(0.0))
                       .statements;
  add_remarks(rays, result);
}

}  // namespace

FitProblem fit_problem(const DesignProblem& problem, const DesignOptions& options, DesignRays& rays) {
  FitProblem fit{&rays, problem.reflectance, {}, target_window(problem), problem.target.mode};
  fit.seed = options.seed;
  fit.fruitless = problem.attempts;
  rays.grow(kFluxRays);
  if (problem.target.mode == TargetMode::shape) {
    EvaluationOptions plain;
    plain.rays = kFluxRays;
    plain.derivatives = false;
    const Evaluation start = evaluate(problem.start, problem.reflectance, rays, fit.bins, plain);
    fit.flux_weight = kFluxWeight;
    fit.flux_reference = start.reflected + start.direct;
  }
  LightLimits(problem.limits, problem.reflectance).check(problem.start, rays);
  fit.limits = limits_cost(problem, rays);
  fit.target = target_flux(problem.target, problem.world_from_mirror, rays.flux());
  fit.rectangle = target_rectangle(problem.target);
  fit.mirror_from_world = problem.world_from_mirror.inverse();
  if (uses_free_form_search(problem)) fit.flux_weight *= kFluxWeightOfSearch / kFluxWeight;
  return fit;
}

DesignResult design(const DesignProblem& problem, const DesignOptions& options, Progress& progress,
                    const DesignObserver& observer) {
  TimeBudget time(options.time_s.value_or(problem.time_s), options.judge_rays + options.rays_after);
  DesignRays rays(problem.project.scene.sources, problem.world_from_mirror.inverse(), options.seed);
  rays.evaluate_on(options.accelerator);
  FitProblem fit_data = fit_problem(problem, options, rays);
  DesignResult result{problem.start};
  search_mirror({problem, options, problem_key(problem, options), time, progress, observer}, fit_data,
                result);
  result.shape = ShapeLimits(problem.limits, problem.start).nearest(result.shape);
  std::uint64_t judge_rays = options.judge_rays;
  if (result.end != DesignEnd::converged) {
    judge_rays = time.affordable(judge_rays, options.rays_after, std::min(judge_rays, kFewestJudgeRays));
  }
  if (result.end == DesignEnd::interrupted) judge_rays = std::min(judge_rays, kFewestJudgeRays);
  judge(problem, options, fit_data, judge_rays, result, progress);
  return result;
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
