// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/fit/missing_light.h"
#include "lucerna/design/shape/conjugate_solution.h"
#include "lucerna/design/shape/perturbed.h"

namespace lucerna {

namespace {

/// Steps in a row, each five times as damped as the one before, after which a stage is at its end.
constexpr int kMaxRefused = 5;

/// Rays that tell where the source is.
constexpr std::uint64_t kSourceRays = 1 << 13;

/// FitProblem::flux_weight, where ends are compared: on the way light must not get lost for a little less
/// error, but of two mirrors at the end the one whose light is right is wanted. A tenth of the light counts
/// as 1 %.
constexpr double kFluxWeightOfEnds = 0.01;

Eigen::VectorXd to_eigen(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

/// Begins with `shape` unless there are starts.
FitProblem with_starts(FitProblem problem, const DesignShape& shape) {
  if (problem.guesses.empty()) problem.guesses = {{shape}};
  return problem;
}

}  // namespace

Fit::Fit(const FitProblem& problem, const ContinuationSchedule& schedule, const DesignShape& shape,
         std::vector<double> search_costs)
    : problem_(with_starts(problem, shape)),
      policy_(restart_rules(problem_), schedule),
      family_(shape),
      shape_(shape) {
  state_.search_costs = std::move(search_costs);
  state_.evaluations = static_cast<int>(state_.search_costs.size());
  state_.total_rays = problem_.search_rays;
  take(policy_.first());
}

Fit::Fit(const FitProblem& problem, const ContinuationSchedule& schedule, const DesignShape& family,
         const FitState& state)
    : problem_(with_starts(problem, family)),
      policy_(restart_rules(problem_), schedule),
      family_(family),
      shape_(family_.refined(state.intervals_x, state.intervals_y).with(to_eigen(state.parameters))),
      state_(state) {}

void Fit::set_shape(const DesignShape& shape) {
  shape_ = shape;
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  state_.intervals_x = shape_.intervals_x();
  state_.intervals_y = shape_.intervals_y();
}

void Fit::begin_with(const DesignShape& start, std::size_t stage) {
  const FitStage& s = schedule()[stage];
  set_shape(start.refined(s.intervals_x, s.intervals_y));
  state_.stage = static_cast<int>(stage);
  state_.lambda = FitState{}.lambda;
}

void Fit::begin_stage(Progress& progress) {
  const FitStage& s = stage();
  const bool other = s.intervals_x != shape_.intervals_x() || s.intervals_y != shape_.intervals_y();
  // A stage that is taken up again in its middle has its knots already.
  if (other && state_.step == 0 && (!s.grow || state_.error_to_noise > kGoodErrorToNoise)) {
    set_shape(shape_.refined(s.intervals_x, s.intervals_y));
  }
  objective_.emplace(problem_, s, progress);
  point_.emplace(objective_->at(shape_));
  if (state_.step > 0) return;
  ++state_.evaluations;
  state_.total_rays += point_->light.rays;
  state_.costs = {point_->equations.cost};
}

bool Fit::stage_ended() const {
  if (state_.step >= stage().max_steps || state_.refused >= kMaxRefused) return true;
  const bool last = state_.stage + 1 == static_cast<int>(schedule().size());
  if (!last && objective_->at_noise(*point_)) return true;
  const std::vector<double>& c = state_.costs;
  return c.size() >= 3 && std::sqrt(c.back()) > (1.0 - stage().min_gain) * std::sqrt(c[c.size() - 3]);
}

void Fit::finish_stage() {
  state_.error_to_noise =
      std::sqrt(point_->equations.cost) / std::max(objective_->error(*point_).floor, 1e-12);
  const FitSnapshot now = snapshot();
  const auto ended = static_cast<std::size_t>(state_.stage);
  ++state_.stage;
  state_.step = 0;
  state_.refused = 0;
  state_.costs.clear();
  state_.lambda = std::clamp(state_.lambda, 1e-4, 1e-2);
  objective_.reset();
  point_.reset();
  take(policy_.after(ended, now, state_.restart));
}

void Fit::take(const FitBranch& branch) {
  switch (branch.kind) {
    case FitBranch::Kind::next:
      return;
    case FitBranch::Kind::restored:
      state_.error_to_noise = branch.snapshot.error_to_noise;
      [[fallthrough]];
    case FitBranch::Kind::end:
      set_shape(shape_of(branch.snapshot));
      state_.stage = static_cast<int>(branch.stage);
      return;
    case FitBranch::Kind::conjugate:
      begin_with(conjugate(), branch.stage);
      return;
    case FitBranch::Kind::begin:
      begin_with(branch.start ? problem_.guesses[*branch.start].shape : shape_of(branch.snapshot),
                 branch.stage);
      break;
  }
  if (branch.perturbation <= 0.0) return;
  const double size_mm = branch.perturbation * shape_.radius_mm();
  set_shape(perturbed(shape_, size_mm, Rng(problem_.seed, branch.stream)));
}

FitSnapshot Fit::snapshot() const {
  const double missing = missing_light(point_->light.flux.sum(), problem_.flux_reference);
  const double less = std::max(0.0, problem_.flux_weight - kFluxWeightOfEnds) * missing * missing;
  const double cost = point_->equations.cost;
  return {
      cost, state_.error_to_noise, cost - less, state_.intervals_x, state_.intervals_y, state_.parameters};
}

DesignShape Fit::shape_of(const FitSnapshot& snapshot) const {
  return family_.refined(snapshot.intervals_x, snapshot.intervals_y).with(to_eigen(snapshot.parameters));
}

DesignShape Fit::conjugate() const {
  return conjugate_solution(shape_, point_source(*problem_.rays, kSourceRays).at_mm.z);
}

DesignShape Fit::best() const {
  const RestartState& r = state_.restart;
  if (r.best.exists()) return shape_of(r.best);
  const bool exploring = schedule().screens_from(static_cast<std::size_t>(state_.stage));
  return r.screened.exists() && exploring ? shape_of(r.screened) : shape_;
}

FitRecord Fit::step(Progress& progress) {
  LUCERNA_CHECK(!done(), "a step after the last stage");
  if (!objective_) begin_stage(progress);
  const LevenbergMarquardtStep step = objective_->step(*point_, state_.lambda);
  ++state_.evaluations;
  state_.total_rays += point_->light.rays;
  state_.lambda = step.next_lambda;
  state_.refused = step.accepted ? 0 : state_.refused + 1;
  if (step.accepted) {
    state_.costs.push_back(point_->equations.cost);
    set_shape(point_->shape);
  }
  const BinError error = objective_->error(*point_);
  FitRecord record;
  record.stage = state_.stage;
  record.step = ++state_.step;
  record.lambda = step.tried_lambda;
  record.accepted = step.accepted;
  record.rays = point_->light.rays;
  record.total_rays = state_.total_rays;
  record.evaluations = state_.evaluations;
  record.error = error.relative_rms;
  record.floor = error.floor;
  record.efficiency = point_->light.reflected + point_->light.direct;
  if (stage_ended()) finish_stage();
  return record;
}

}  // namespace lucerna
