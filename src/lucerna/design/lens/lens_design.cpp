// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_design.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <string>
#include <utility>

#include "lucerna/design/constraints/limit_check.h"
#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/free_face_fit.h"
#include "lucerna/design/lens/lens_validation.h"
#include "lucerna/design/validation/error_boxes.h"
#include "lucerna/design/validation/result_remarks.h"

namespace lucerna {

namespace {

/// Rays that the given lens is validated with, at most, and the share of the time that validation may take.
constexpr std::uint64_t kGivenRays = std::uint64_t{1} << 20;
constexpr double kValidationShare = 0.15;
/// Triangles of a lens take so many times as long as its exact surfaces.
constexpr double kTrianglesTime = 10.0;
/// Cavities that are compared, by the time: a trial takes about a second.
constexpr double kTrialsPerSecond = 0.4, kMinTrials = 10.0, kMaxTrials = 24.0;

/// Against the target, as often as it is asked for.
class LensCheck {
 public:
  LensCheck(const LensProblem& problem, const LensOptions& options, Progress& progress)
      : problem_(problem),
        options_(options),
        progress_(progress),
        boxes_(target_rectangle(problem.target)),
        target_(box_target(boxes_, problem.target, total_flux(problem.project.scene.sources))) {}

  /// The given lens, which nothing has been fitted to: exact surfaces are ten times as fast.
  LensValidation of_given(std::uint64_t rays, double max_s) const {
    return of({problem_.start}, LensSurface::exact, rays, max_s);
  }
  /// What is printed: triangles, that no fit has seen. Lenses with a face would be too many triangles.
  LensValidation operator()(const ShapedLens& lens, std::uint64_t rays, double max_s) const {
    return of(lens, problem_.free_face ? LensSurface::exact : LensSurface::triangles, rays, max_s);
  }

 private:
  LensValidation of(const ShapedLens& lens, LensSurface surface, std::uint64_t rays, double max_s) const {
    return validate_lens(with_lens(problem_, lens).scene, surface, boxes_, target_, problem_.target.mode,
                         options_.seed, rays, max_s, progress_);
  }

  const LensProblem& problem_;
  const LensOptions& options_;
  Progress& progress_;
  ErrorBoxes boxes_;
  std::vector<double> target_;
};

void set_findings(const LensValidation& v, LensResult& result) {
  result.error = v.error;
  result.efficiency = v.efficiency;
  result.bodies = v.absorbed;
  result.lost = v.lost;
  result.validation_s += v.seconds;
}

LensFitResult fitted(const LensProblem& problem, const LensFitOptions& options, const LensFitWatcher& watch) {
  if (problem.free_face) return fit_free_face(problem, options, watch);
  DesignRays rays(problem.project.scene.sources, problem.world_from_lens.inverse(), options.seed);
  return fit_lens(problem, options, rays, watch);
}

bool given_is_better(const LensProblem& problem, const DesignError& given, const DesignError& found) {
  const double noise = 2.0 * std::hypot(given.c48.standard_error, found.c48.standard_error);
  return error_with_light(given, problem.light_weight) + noise <
         error_with_light(found, problem.light_weight);
}

std::string entry_text(const Cavity& c) {
  return c.depth_mm > 0.0 ? fmt::format("the light enters by a cavity {:.3g} mm wide and {:.3g} mm deep",
                                        2.0 * c.radius_mm, c.depth_mm)
                          : "the light enters by a flat base";
}

void add_lens_remarks(LensResult& result) {
  if (const auto none = no_step_remark(result)) result.remarks.push_back(*none);
  if (const auto noise = noise_remark(result.error)) result.remarks.push_back(*noise);
  for (std::string& broken : broken_limits(result.limits)) result.remarks.push_back(std::move(broken));
}

}  // namespace

LensResult design_lens(const LensProblem& problem, const LensOptions& options, Progress& progress,
                       const LensObserver& observer) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point begin = Clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(Clock::now() - begin).count(); };
  const double time_s = options.time_s.value_or(problem.time_s);
  const LensCheck check(problem, options, progress);
  const LensValidation given = check.of_given(std::min(kGivenRays, options.validation_rays), 0.05 * time_s);
  if (!given.has_light) {
    throw InputError(
        fmt::format("no light reaches the lens: of {} rays none meets it; check position_mm and "
                    "axis of source and body",
                    given.rays));
  }
  const double slower = problem.free_face ? 1.0 : kTrianglesTime;
  const double per_ray_s = slower * given.seconds / static_cast<double>(given.rays);
  const double after_s =
      std::min(kValidationShare * time_s, per_ray_s * static_cast<double>(options.validation_rays));
  double last_s = -1.0;
  const LensFitWatcher watch = [&](const FitRecord& step, const ShapedLens& best) {
    if (observer) observer(step, best);
    // What comes before the first step comes once.
    const double now = seconds(), step_s = last_s < 0.0 ? 0.0 : now - last_s;
    last_s = now;
    return !progress.stop_requested() && now + step_s + after_s < time_s;
  };
  const double trials = std::clamp(kTrialsPerSecond * time_s, kMinTrials, kMaxTrials);
  LensFitResult fit =
      fitted(problem, {options.seed, options.max_rays, static_cast<std::size_t>(trials)}, watch);
  LensResult result(fit.lens);
  result.end = progress.stop_requested() ? DesignTermination::interrupted : fit.end;
  result.evaluations = fit.evaluations;
  result.rays = fit.rays;
  result.history = std::move(fit.history);
  const double left_s = std::max(0.05 * time_s, time_s - seconds());
  set_findings(check(result.lens, options.validation_rays, left_s), result);
  result.start_error = given.error;
  const auto signs = draft_signs(problem.start);
  result.limits = result.lens.face
                      ? check_face_limits(problem.limits, seat_of(result.lens), *result.lens.face)
                      : check_lens_limits(problem.limits, result.lens.outline, signs);
  const auto given_limits = check_lens_limits(problem.limits, problem.start, signs);
  const bool given_holds =
      std::all_of(given_limits.begin(), given_limits.end(), [](const LimitCheck& c) { return c.held; });
  if (given_holds && given_is_better(problem, given.error, result.error)) {
    result.lens = {problem.start};
    result.limits = given_limits;
    set_findings(check(result.lens, options.validation_rays, left_s), result);
    result.remarks.emplace_back("the given lens is the result: nothing that was found is better");
  } else if (fit.cavity) {
    result.remarks.push_back(entry_text(*fit.cavity));
  }
  add_lens_remarks(result);
  return result;
}

}  // namespace lucerna
