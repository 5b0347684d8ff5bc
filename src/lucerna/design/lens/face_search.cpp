// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/face_search.h"

#include <utility>

#include "lucerna/design/lens/other_light.h"

namespace lucerna {

namespace {

/// Rays that tell what enters the lens and how much of it the given face lets through.
constexpr std::uint64_t kLightRays = std::uint64_t{1} << 16;

/// Light that goes other ways is looked at by so much fewer rays than the light that is fitted: on the levels
/// that end a search its noise would be most of what is left.
constexpr std::uint64_t kFewerRays = 8, kFewerRaysAtEnd = 2, kRaysAtEnd = std::uint64_t{1} << 22;

/// Of a rough face.
constexpr StartLight kRoughLight{std::uint64_t{1} << 15, 28, 20, 3};
constexpr int kRoughBins = 40, kRoughSteps = 3;

DesignShape given_face(const LensProblem& problem) {
  return face_of(problem.start, problem.free_face->intervals, problem.limits.symmetry);
}

/// The given face's knots through the heights of another.
DesignShape with_heights_of(const DesignShape& given, const std::optional<DesignShape>& face) {
  if (!face) return given;
  return given.through([&](double x, double y) { return face->at(x, y).z_mm; });
}

}  // namespace

FaceSearch::FaceSearch(const LensProblem& problem, const LensFitOptions& options)
    : FaceSearch(problem, options, std::nullopt, given_face(problem), false) {}

FaceSearch::FaceSearch(const LensProblem& problem, const LensFitOptions& options, double flux_reference,
                       const std::optional<DesignShape>& begin)
    : FaceSearch(problem, options, flux_reference, with_heights_of(given_face(problem), begin), true) {}

FaceSearch::FaceSearch(LensProblem problem, const LensFitOptions& options,
                       std::optional<double> flux_reference, const DesignShape& begin, bool is_chosen)
    : problem_(std::move(problem)),
      start_(begin),
      seat_(face_seat(problem_.start)),
      limits_(std::make_shared<const ShapeLimits>(face_limits(problem_.limits, seat_, start_, kFitRings))),
      rays_(problem_.project.scene.sources, world_from_design().inverse(), options.seed),
      seed_(options.seed),
      within_(entered()),
      fit_(fit_problem(flux_reference, is_chosen)),
      search_(fit_, start_, problem_.free_face->max_intervals, options.max_rays) {}

double FaceSearch::entered() {
  rays_.refract(problem_.medium, into_lens(problem_.start, problem_.medium));
  rays_.grow(kLightRays);
  return rays_.share_left(kLightRays);
}

FitProblem FaceSearch::fit_problem(std::optional<double> flux_reference, bool is_chosen) {
  const DesignTarget& target = problem_.target;
  FitProblem fit{&rays_, Reflectance(1.0),
                 // An evaluation's shares are of the light within.
                 target_flux(target, world_from_design(), rays_.flux() * within_),
                 target_bins(target, world_from_design(), false), target.mode};
  fit.seed = seed_;
  fit.start_is_chosen = is_chosen;
  fit.max_failed_restarts = problem_.max_failed_restarts;
  fit.direct_light = false;
  fit.outside_weight = problem_.free_face->outside_weight;
  if (target.mode == TargetMode::shape) {
    fit.flux_weight = problem_.light_weight;
    fit.flux_reference = flux_reference ? *flux_reference / within_ : passed_by_start(fit);
  }
  fit.limits = [this](const DesignShape& shape, std::uint64_t, ResidualRows* rows) {
    return limits_->cost(shape, rows);
  };
  fit.form = limits_;
  fit.within = [this](const DesignShape& shape) { return within_limits(problem_.limits, seat_, shape); };
  fit.other_light = [this](const DesignShape& face, const TentBins& bins,
                           std::uint64_t count) -> Eigen::VectorXd {
    const std::uint64_t fewer = count < kRaysAtEnd ? kFewerRays : kFewerRaysAtEnd;
    return other_light(problem_, {problem_.start, face}, bins, count / fewer, seed_) / within_;
  };
  fit.rectangle = target_rectangle(target);
  fit.mirror_from_world = world_from_design().inverse();
  return fit;
}

double FaceSearch::passed_by_start(const FitProblem& fit) const {
  EvaluationOptions plain;
  plain.rays = kLightRays;
  plain.derivatives = plain.direct_light = false;
  const double straight = evaluate(start_, fit.reflectance, rays_, fit.bins, plain).reflected;
  return straight +
         other_light(problem_, {problem_.start, start_}, fit.bins, kLightRays, seed_).sum() / within_;
}

ShapedLens FaceSearch::held() const {
  const DesignShape best = search_.best();
  const ShapeLimits fine = face_limits(problem_.limits, seat_, start_, kCheckRings);
  return {problem_.start, fine.held_nearby(best).value_or(best)};
}

std::optional<FaceSearch::RoughFace> FaceSearch::rough(double distance) {
  FitProblem straight = fit_;
  straight.other_light = {};
  TransportChoice choice = search_.first_choice(1);
  choice.vertex_distance_mm *= distance;
  const auto guess = free_form_guess(straight, start_, choice, kRoughLight);
  if (!guess) return std::nullopt;
  FreeFormLevel level = search_.level(0);
  level.bins = kRoughBins;
  const FreeFormFit fit(straight, level);
  FreeFormPoint point = fit.at(*straight.within(*guess));
  double lambda = FreeFormState{}.lambda;
  for (int k = 0; k < kRoughSteps; ++k) static_cast<void>(fit.step(point, lambda));
  const BinError error = fit.error(point);
  FitRecord record;
  record.accepted = true;
  record.step = kRoughSteps;
  record.rays = level.rays;
  record.evaluations = 1 + kRoughSteps;
  record.total_rays = level.rays * static_cast<std::uint64_t>(record.evaluations);
  record.error = error.relative_rms;
  record.floor = error.floor;
  record.lambda = lambda;
  record.efficiency = point.light.reflected;
  record.in_rectangle = fit.in_rectangle(point);
  return RoughFace{point.shape, record, point.equations.cost - error.floor * error.floor};
}

}  // namespace lucerna
