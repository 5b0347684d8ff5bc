// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/error.h"
#include "lucerna/design/limits.h"
#include "lucerna/design/window.h"

namespace lucerna {

namespace {

/// Width of the strip that stands for a rim, over the mirror's radius.
constexpr double kRimShare = 0.02;

/// A start is good when its error is at most this many times the noise: above it something is left to gain.
constexpr double kGateFloors = 1.5;

/// Longest change of a height in one step, over the mirror's radius: the model of a step is not good for
/// more.
constexpr double kLongestStep = 0.05;

Eigen::VectorXd to_eigen(const std::vector<double>& v) {
  return Eigen::Map<const Eigen::VectorXd>(v.data(), static_cast<Eigen::Index>(v.size()));
}

}  // namespace

Fit::Fit(const FitProblem& problem, std::vector<FitStage> stages, const DesignShape& shape)
    : problem_(problem), stages_(std::move(stages)), family_(shape), shape_(shape), bins_(problem.bins) {
  LUCERNA_CHECK(!stages_.empty(), "a fit without stages");
  state_.intervals_x = shape.intervals_x();
  state_.intervals_y = shape.intervals_y();
  set_shape({}, stages_[0].intervals_x, stages_[0].intervals_y);
  state_.start_parameters = state_.parameters;
}

Fit::Fit(const FitProblem& problem, std::vector<FitStage> stages, const DesignShape& family,
         const FitState& state)
    : problem_(problem),
      stages_(std::move(stages)),
      family_(family),
      shape_(family.refined(state.intervals_x, state.intervals_y).with(to_eigen(state.parameters))),
      state_(state),
      bins_(problem.bins) {}

void Fit::set_shape(const std::vector<double>& parameters, int intervals_x, int intervals_y) {
  shape_ = family_.refined(intervals_x, intervals_y);
  if (!parameters.empty()) shape_ = shape_.with(to_eigen(parameters));
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  state_.intervals_x = intervals_x;
  state_.intervals_y = intervals_y;
}

Evaluation Fit::evaluate_at(const DesignShape& shape) {
  EvaluationOptions options;
  options.rays = stage().rays;
  options.direct_light = problem_.direct_light;
  options.rim_mm = kRimShare * shape.aperture().outer_radius_mm();
  return evaluate(shape, problem_.reflectance, *problem_.rays, bins_, options);
}

void Fit::begin_stage(Progress& progress) {
  const FitStage& s = stage();
  problem_.rays->grow(s.rays, progress);
  if (s.intervals_x != shape_.intervals_x() || s.intervals_y != shape_.intervals_y()) {
    shape_ = shape_.refined(s.intervals_x, s.intervals_y);
  }
  state_.intervals_x = s.intervals_x;
  state_.intervals_y = s.intervals_y;
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  bins_ = rebinned(problem_.bins, s.widen, s.bins);
  target_ = problem_.target(bins_);
  now_ = evaluate_at(shape_);
  equations_ = equations_at(shape_, now_);
  ready_ = true;
}

bool Fit::stalled() const {
  const std::vector<double>& c = state_.costs;
  if (c.size() < 3) return false;
  return std::sqrt(c.back()) > (1.0 - stage().least_gain) * std::sqrt(c[c.size() - 3]);
}

void Fit::finish_stage() {
  const bool gate = stage().gate;
  ++state_.stage;
  state_.step = 0;
  state_.costs.clear();
  state_.lambda = std::clamp(state_.lambda, 1e-4, 1e-2);
  ready_ = false;
  if (gate) pass_gate();
}

void Fit::pass_gate() {
  const int x = state_.intervals_x, y = state_.intervals_y;
  if (state_.starts == 0 || equations_.cost < state_.gate_cost) {
    state_.gate_cost = equations_.cost;
    state_.gate_parameters = state_.parameters;
    state_.gate_intervals_x = x;
    state_.gate_intervals_y = y;
  }
  const double floor = bin_error(now_, target_, bins_, problem_.mode).floor;
  ++state_.starts;
  if (state_.gate_cost <= kGateFloors * kGateFloors * floor * floor || state_.starts > problem_.restarts) {
    set_shape(state_.gate_parameters, x, y);
    return;
  }
  std::vector<double> shaken = state_.start_parameters;
  Rng rng(problem_.seed, static_cast<std::uint64_t>(state_.starts));
  const double size = problem_.shake * shape_.aperture().outer_radius_mm();
  for (double& p : shaken) p += size * (2.0 * rng.uniform() - 1.0);
  state_.stage = 0;
  state_.lambda = FitState{}.lambda;
  set_shape(shaken, stages_[0].intervals_x, stages_[0].intervals_y);
}

DesignShape Fit::best() const {
  const bool trying_again = state_.starts > 0 && std::any_of(stages_.begin() + state_.stage, stages_.end(),
                                                             [](const FitStage& s) { return s.gate; });
  if (!trying_again) return shape_;
  return family_.refined(state_.gate_intervals_x, state_.gate_intervals_y)
      .with(to_eigen(state_.gate_parameters));
}

NormalEquations Fit::equations_at(const DesignShape& shape, const Evaluation& e) const {
  NormalEquations equations = normal_equations(e, target_, bins_, problem_.mode);
  if (problem_.limits) equations.cost += problem_.limits(shape, stage().rays, &equations);
  if (problem_.flux_weight > 0.0) {
    add_flux_term(e, problem_.flux_weight, problem_.flux_reference, equations);
  }
  return equations;
}

double Fit::error() const { return std::sqrt(equations_.cost); }

FitRecord Fit::step(Progress& progress) {
  LUCERNA_CHECK(!done(), "a step after the last stage");
  if (!ready_) {
    begin_stage(progress);
    if (state_.step == 0) {
      ++state_.evaluations;
      state_.total_rays += now_.rays;
      state_.costs = {equations_.cost};
    }
  }
  Eigen::VectorXd move = damped_step(equations_, state_.lambda);
  const double longest = kLongestStep * shape_.aperture().outer_radius_mm();
  while (!(move.cwiseAbs().maxCoeff() <= longest)) {
    state_.lambda *= 4.0;
    move = damped_step(equations_, state_.lambda);
  }
  FitRecord record;
  record.stage = state_.stage;
  record.step = ++state_.step;
  record.lambda = state_.lambda;
  const DesignShape trial = shape_.with(shape_.parameters() + move);
  Evaluation e = evaluate_at(trial);
  ++state_.evaluations;
  state_.total_rays += e.rays;
  NormalEquations equations = equations_at(trial, e);
  record.accepted = equations.cost < equations_.cost;
  const double predicted = -(equations_.gradient.dot(move) * 2.0 +
                             move.dot(equations_.hessian.selfadjointView<Eigen::Lower>() * move));
  if (record.accepted) {
    const double gain = (equations_.cost - equations.cost) / predicted;
    state_.lambda = std::max(1e-7, state_.lambda * (gain > 0.75 ? 0.2 : (gain > 0.25 ? 0.6 : 2.0)));
    shape_ = trial;
    now_ = std::move(e);
    equations_ = std::move(equations);
    state_.costs.push_back(equations_.cost);
  } else {
    state_.lambda *= 6.0;
  }
  state_.parameters.assign(shape_.parameters().begin(), shape_.parameters().end());
  state_.intervals_x = shape_.intervals_x();
  state_.intervals_y = shape_.intervals_y();
  const BinError error = bin_error(now_, target_, bins_, problem_.mode);
  record.rays = now_.rays;
  record.total_rays = state_.total_rays;
  record.evaluations = state_.evaluations;
  record.error = error.relative_rms;
  record.floor = error.floor;
  record.efficiency = now_.reflected + now_.direct;
  if (state_.step >= stage().most_steps || state_.lambda > 1e4 || stalled()) finish_stage();
  return record;
}

}  // namespace lucerna
