// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/free_face_fit.h"

#include <cmath>

#include "lucerna/design/lens/free_face.h"
#include "lucerna/design/lens/other_light.h"
#include "lucerna/design/search/free_form_search.h"

namespace lucerna {

namespace {

/// Rays that tell what enters the lens and how much of it the given face lets through.
constexpr std::uint64_t kLightRays = std::uint64_t{1} << 16;

/// Light that goes other ways is looked at by so much fewer rays than the light that is fitted: on the levels
/// that end a search its noise would be most of what is left.
constexpr std::uint64_t kFewerRays = 8, kFewerRaysAtEnd = 2, kRaysAtEnd = std::uint64_t{1} << 22;

/// Share of the source's flux that is within the medium.
double share_within(const DesignRays& rays, std::uint64_t count) {
  double within = 0.0, n = 0.0;
  for (std::uint64_t b = 0; b < count / kBlockRays; ++b) {
    for (const float w : rays.block(b).weight) within += static_cast<double>(w);
    n += static_cast<double>(kBlockRays);
  }
  return within / n;
}

FitProblem face_problem(const LensProblem& problem, const LensFitOptions& options, const DesignShape& start,
                        const FaceSeat& seat, std::shared_ptr<const ShapeLimits> limits, DesignRays& rays) {
  const Frame world_from_design = problem.world_from_lens * lens_from_design();
  FitProblem fit{&rays,
                 Reflectance(1.0),
                 {},
                 target_bins(problem.target, world_from_design, false),
                 problem.target.mode};
  fit.seed = options.seed;
  fit.max_failed_restarts = problem.max_failed_restarts;
  fit.direct_light = false;
  rays.grow(kLightRays);
  // An evaluation's shares are of the light within.
  const double within = share_within(rays, kLightRays);
  fit.target = target_flux(problem.target, world_from_design, rays.flux() * within);
  if (problem.target.mode == TargetMode::shape) {
    EvaluationOptions plain;
    plain.rays = kLightRays;
    plain.derivatives = plain.direct_light = false;
    fit.flux_weight = problem.free_face->light_weight;
    fit.flux_reference = evaluate(start, fit.reflectance, rays, fit.bins, plain).reflected;
  }
  fit.limits = [limits](const DesignShape& shape, std::uint64_t, ResidualRows* rows) {
    return limits->cost(shape, rows);
  };
  fit.form = std::move(limits);
  fit.within = [&problem, &seat](const DesignShape& shape) {
    return within_limits(problem.limits, seat, shape);
  };
  fit.other_light = [&problem, within, seed = options.seed](const DesignShape& face, const TentBins& bins,
                                                            std::uint64_t count) -> Eigen::VectorXd {
    const std::uint64_t fewer = count < kRaysAtEnd ? kFewerRays : kFewerRaysAtEnd;
    return other_light(problem, face, bins, count / fewer, seed) / within;
  };
  fit.rectangle = target_rectangle(problem.target);
  fit.mirror_from_world = world_from_design.inverse();
  return fit;
}

}  // namespace

LensFitResult fit_free_face(const LensProblem& problem, const LensFitOptions& options,
                            const LensFitWatcher& watch) {
  const DesignShape start = face_of(problem.start, problem.free_face->intervals);
  const FaceSeat seat = face_seat(problem.start);
  const auto limits =
      std::make_shared<const ShapeLimits>(face_limits(problem.limits, seat, start, kFitRings));
  DesignRays rays(problem.project.scene.sources, (problem.world_from_lens * lens_from_design()).inverse(),
                  options.seed);
  rays.refract(problem.medium, into_lens(problem.start, problem.medium));
  const FitProblem fit = face_problem(problem, options, start, seat, limits, rays);
  FreeFormSearch search(fit, start, problem.free_face->max_intervals, options.max_rays);
  LensFitResult result({problem.start, start});
  while (!search.done()) {
    const std::optional<FitRecord> record = search.step();
    if (!record) continue;
    result.history.push_back(*record);
    if (watch(*record, {problem.start, search.best()})) continue;
    result.end = DesignTermination::time;
    break;
  }
  // A design is not lost where no such face is found: the check of its limits says so.
  const ShapeLimits fine_limits = face_limits(problem.limits, seat, start, kCheckRings);
  result.lens.face = fine_limits.held_nearby(search.best()).value_or(search.best());
  result.evaluations = search.state().evaluations;
  result.rays = search.state().total_rays;
  return result;
}

}  // namespace lucerna
