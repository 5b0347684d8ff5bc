// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/stage_objective.h"

#include <utility>

#include "lucerna/design/evaluation/window.h"
#include "lucerna/design/fit/missing_light.h"
#include "lucerna/design/solver/smoothness_penalty.h"

namespace lucerna {

namespace {

/// Longest change of a height in one step, over the mirror's radius: the model of a step is not good for
/// more.
constexpr double kLongestStep = 0.05;

}  // namespace

StageObjective::StageObjective(const FitProblem& problem, const FitStage& stage, Progress& progress)
    : problem_(problem),
      stage_(stage),
      bins_(rebinned(problem.bins, stage.widen, stage.bins)),
      target_(problem.target(bins_)) {
  problem_.rays->grow(stage.rays, progress);
  if (stage.cutoff > 0.0) scale_.emplace(bins_, stage.cutoff);
}

FitPoint StageObjective::at(DesignShape shape) const {
  EvaluationOptions options;
  options.rays = stage_.rays;
  options.direct_light = problem_.direct_light;
  options.rim_mm = kRimShare * shape.radius_mm();
  Evaluation light = evaluate(shape, problem_.reflectance, *problem_.rays, bins_, options);
  NormalEquations next = equations(shape, light);
  return {std::move(shape), std::move(light), std::move(next)};
}

NormalEquations StageObjective::equations(const DesignShape& shape, const Evaluation& light) const {
  NormalEquations equations =
      scale_ ? normal_equations((*scale_)(light), scale_->flux(target_), bins_, problem_.mode)
             : normal_equations(light, target_, bins_, problem_.mode);
  ResidualRows rows;
  equations.cost += smoothness_penalty(shape, stage_.smoothing, 1.0, &rows);
  equations.cost += problem_.limits_cost(shape, stage_.rays, &rows);
  rows.add_to(equations);
  if (problem_.flux_weight > 0.0) {
    add_missing_light(light, problem_.flux_weight, problem_.flux_reference, equations);
  }
  return equations;
}

LevenbergMarquardtStep StageObjective::step(FitPoint& now, double lambda) const {
  const Eigen::VectorXd from = now.shape.parameters();
  const double longest = kLongestStep * now.shape.radius_mm();
  const auto metric = step_metric(now.shape, now.equations);
  return levenberg_marquardt_step(
      now, [&](double damping) { return damped_step(now.equations, metric, damping); }, lambda, longest,
      [&](const Eigen::VectorXd& move) { return at(now.shape.with(from + move)); });
}

BinError StageObjective::error(const FitPoint& point) const {
  return bin_error(point.light, target_, bins_, problem_.mode);
}

bool StageObjective::at_noise(const FitPoint& point) const {
  const double floor = error(point).floor;
  return !scale_ && point.equations.cost <= floor * floor;
}

}  // namespace lucerna
