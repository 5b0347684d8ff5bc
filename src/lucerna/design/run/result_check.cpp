// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/result_check.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "lucerna/cad.h"
#include "lucerna/design/constraints/limit_check.h"
#include "lucerna/design/constraints/source_side.h"
#include "lucerna/design/validation/bounds.h"
#include "lucerna/design/validation/etendue_limit.h"
#include "lucerna/design/validation/mesh_tolerance.h"
#include "lucerna/design/validation/result_remarks.h"
#include "lucerna/design/validation/validation.h"
#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

namespace {

/// Rays that limits on light are checked with, and that the start is validated with, at most.
constexpr std::uint64_t kLimitRays = std::uint64_t{1} << 20, kStartCheckRays = std::uint64_t{1} << 20;
/// The share of a design's time that the start's validation may take.
constexpr double kStartShare = 0.05;
/// Of the mesh where few rays are traced: a finer one would cost more than the rays.
constexpr CadTolerance kCoarseMesh{.chord_mm = 0.01, .slope_deg = 0.5};

/// All limits that are set, against the mesh that is exported within `stl`, and fresh light, of which
/// `efficiency` leaves, and whose brightest cell of glare is `glare_per_flux`.
std::vector<LimitCheck> checked_limits(const DesignProblem& problem, const DesignShape& shape,
                                       CadTolerance stl, double source_flux, const Estimate& efficiency,
                                       const Estimate& glare_per_flux) {
  std::vector<LimitCheck> out;
  const DesignLimits& limits = problem.limits;
  if (limits.any_on_form()) {
    const Mesh mesh = cad_mesh_within(shape.reflector(), stl);  // `stl` becomes what the mesh keeps
    out = check_limits(mesh, limits, stl.chord_mm, stl.slope_deg);
  }
  if (limits.glare) {
    const double max = limits.glare->max_per_flux * source_flux;
    const Estimate has{glare_per_flux.mean * source_flux, glare_per_flux.standard_error * source_flux};
    out.push_back({"glare " + limits.glare->text, max, has, has.mean <= max});
  }
  if (limits.min_efficiency) {
    out.push_back(
        {"min_efficiency", *limits.min_efficiency, efficiency, efficiency.mean >= *limits.min_efficiency});
  }
  return out;
}

/// Other rays than those of the search.
DesignRays check_rays(const DesignProblem& problem, const DesignOptions& options, Progress& progress) {
  DesignRays rays = design_rays(problem, options, options.seed + 0x9E3779B97F4A7C15ull);
  rays.grow(std::min(options.validation_rays, kLimitRays), progress);
  return rays;
}

/// Bounds that are missed by less than this in all are as good as met where two mirrors are compared.
constexpr double kMissingNoise = 0.01;

/// A design is never worse than the mirror that was given: by the zones; where these are alike, by the
/// printed error, or without a file to compare with by the light in the rectangle.
bool given_is_better(const DesignProblem& problem, const DesignResult& result) {
  const double missing = missing_in_zones(result.zones), missing_given = missing_in_zones(result.start_zones);
  if (std::abs(missing - missing_given) > kMissingNoise) return missing_given < missing;
  if (problem.target.zones_only) {
    const Estimate &light = result.error.in_rectangle, &light_given = result.start_error.in_rectangle;
    return light_given.mean > light.mean + 2.0 * std::hypot(light.standard_error, light_given.standard_error);
  }
  const BoxErrorEstimate &found = result.error.c48, &given = result.start_error.c48;
  return given.excess + 2.0 * std::hypot(given.standard_error, found.standard_error) < found.excess;
}

/// Only what a figure stands behind.
void add_remarks(const DesignProblem& problem, DesignResult& result) {
  if (const auto none = no_step_remark(result)) result.remarks.push_back(*none);
  const auto noise = problem.target.zones_only ? std::nullopt : noise_remark(result.error);
  if (noise) {
    result.remarks.push_back(*noise);
  } else if (const std::string binding = binding_limits(result.limits); !binding.empty()) {
    result.remarks.push_back(binding);
  }
  for (std::string& broken : broken_limits(result.limits)) result.remarks.push_back(std::move(broken));
}

/// That the limit on glare is broken by light that no mirror has turned.
std::optional<std::string> direct_glare_remark(const DesignLimits& limits, double source_flux,
                                               const GlareFound& glare) {
  if (!limits.glare) return {};
  const Estimate& direct = glare.direct_per_flux;
  if (direct.mean - 2.0 * direct.standard_error <= limits.glare->max_per_flux) return {};
  const Estimate cd{direct.mean * source_flux, direct.standard_error * source_flux};
  return fmt::format("glare {}: light that meets no mirror has {} cd alone", limits.glare->text,
                     estimate_text(cd));
}

}  // namespace

ResultCheck::ResultCheck(const DesignProblem& problem, const DesignOptions& options, Progress& progress)
    : problem_(problem),
      options_(options),
      rays_(check_rays(problem, options, progress)),
      etendue_(rays_),
      boxes_(target_rectangle(problem.target)),
      target_(box_target(boxes_, problem.target, rays_.flux())) {
  if (problem.limits.glare) glare_.emplace(problem.world_from_mirror, problem.limits.glare->beyond_deg);
  const std::uint64_t rays = std::min(options.validation_rays, kStartCheckRays);
  const double max_s = kStartShare * options.time_s.value_or(problem.time_s);
  start_ = validated(problem.start, rays / 8, rays, max_s, progress);
  static_cast<void>(bound(problem.start, start_));  // makes the étendue curves that the result's will need
}

double ResultCheck::seconds(std::uint64_t rays) const {
  const double per_ray_s = (start_.seconds - start_.mesh_s) / static_cast<double>(start_.rays);
  return start_.mesh_s + per_ray_s * static_cast<double>(rays);
}

Validation ResultCheck::validated(const DesignShape& shape, std::uint64_t min_rays, std::uint64_t max_rays,
                                  double max_s, Progress& progress) const {
  Scene scene = problem_.project.scene;
  scene.reflectors.front().reflector = shape.reflector();
  ValidationOptions o;
  o.seed = options_.seed;
  o.min_rays = min_rays;
  o.max_rays = max_rays;
  o.max_s = max_s;
  o.zones = problem_.target.zones.get();
  if (glare_) o.glare = &*glare_;
  o.peers = options_.peers;
  if (options_.validation_rays < kStartCheckRays) o.tolerance = kCoarseMesh;
  return validate(scene, boxes_, target_, problem_.target.mode, o, progress);
}

DesignBound ResultCheck::bound(const DesignShape& shape, const Validation& light) {
  return design_bound(boxes_, target_, problem_.target.mode, light, etendue_, shape,
                      problem_.world_from_mirror.ez());
}

GlareFound ResultCheck::set_error(std::uint64_t max_rays, double max_s, DesignResult& result,
                                  Progress& progress) {
  const Validation v = validated(result.shape, ValidationOptions().min_rays, max_rays, max_s, progress);
  result.error = v.error;
  result.zones = v.zones;
  result.efficiency = v.efficiency;
  result.absorbed = v.absorbed;
  result.back = v.back;
  result.bodies = v.bodies;
  result.lost = v.lost;
  result.validation_s = v.seconds;
  result.start_error = start_.error;
  result.start_zones = start_.zones;
  result.bound = bound(result.shape, v);
  if (!glare_) return {};
  return {glare_->brightest(v.replicates), glare_->brightest(v.replicates, &BoxSums::glare_direct)};
}

void ResultCheck::fill(const FitProblem& fit, std::uint64_t max_rays, double max_s, DesignResult& result,
                       Progress& progress) {
  GlareFound glare = set_error(max_rays, max_s, result, progress);
  const bool keep_given = given_is_better(problem_, result);
  if (keep_given) {
    result.shape = problem_.start;
    glare = set_error(max_rays, max_s, result, progress);
  }
  const CadTolerance stl = mesh_tolerance(boxes_, target_, problem_.world_from_mirror.origin_mm());
  result.limits =
      checked_limits(problem_, result.shape, stl, rays_.flux(), result.efficiency, glare.per_flux);
  const double behind = share_behind(result.shape, rays_), given = share_behind(problem_.start, rays_);
  if (behind > given + kMaxBehind) {
    const double error = std::sqrt(behind * (1.0 - behind) / static_cast<double>(rays_.size()));
    result.limits.push_back(
        {"source in front of the mirror (share behind it)", given, {behind, error}, false});
  }
  if (!problem_.target.zones_only) {
    const EtendueLimit limit = etendue_limit(rays_, etendue_, problem_.start, fit.bins, fit.target(fit.bins),
                                             fit.mode, problem_.limits.min_efficiency.value_or(0.0));
    result.remarks.insert(result.remarks.begin(), limit.statements.begin(), limit.statements.end());
  }
  add_remarks(problem_, result);
  if (auto remark = direct_glare_remark(problem_.limits, rays_.flux(), glare))
    result.remarks.push_back(*remark);
  if (result.shape.is_revolution()) {
    if (auto remark = rings_remark(problem_.target, result.error)) result.remarks.push_back(*remark);
  }
  if (keep_given)
    result.remarks.push_back(
        "the mirror that the search began with is the result: nothing that was found is better");
}

}  // namespace lucerna
