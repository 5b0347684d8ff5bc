// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/free_form_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/design/fit/approach.h"
#include "lucerna/design/fit/missing_light.h"
#include "lucerna/design/solver/levenberg_marquardt.h"
#include "lucerna/design/solver/smoothness_penalty.h"

namespace lucerna {

namespace {

/// Share of a third difference on the axis that counts as roughness.
constexpr double kSmoothnessAtAxis = 0.02;
/// Knots for which a level's smoothing is meant, over the aperture's radius: roughness is that of a third
/// derivative, whatever the knots.
constexpr double kSmoothingStep = 1.0 / 24.0;
/// What a mirror of few knots has of a level's smoothing: its knots are its smoothness.
constexpr double kFewKnots = 1.0 / 300.0;
/// Longest change of a height in one step, over the mirror's radius: the linear model is not good for more.
constexpr double kMaxMove = 0.05;
/// Bins on each side of the widened rectangle out to the horizon; where zones may lie there.
constexpr int kOuterBins = 8, kZoneBins = 24;

/// A step looks so often at the limits that it breaks, unless they cost less than this share of all.
constexpr int kLooksAhead = 5;
constexpr double kLittleCost = 0.01;

double smoothing_for(const DesignShape& shape, double level_smoothing) {
  const Aperture& a = shape.aperture();
  const double along = shape.is_trough() ? 0.0 : a.half_y_mm() / shape.intervals_y();
  const double step = 2.0 * std::max(a.half_x_mm() / shape.intervals_x(), along);
  return level_smoothing * (has_few_knots(shape) ? kFewKnots : 1.0) *
         std::pow(kSmoothingStep * shape.radius_mm() / step, 4);
}

}  // namespace

FreeFormFit::FreeFormFit(const FitProblem& problem, const FreeFormLevel& level, Progress& progress)
    : problem_(problem),
      level_(level),
      bins_(graded_bins(problem.rectangle, problem.mirror_from_world, level.bins, level.widen,
                        problem.zones.cells ? kZoneBins : kOuterBins)),
      target_(problem.target(bins_)),
      inside_(lucerna::in_rectangle(bins_, problem.rectangle)),
      weights_(bin_weights(bins_).array() *
               (problem.outside_weight + (1.0 - problem.outside_weight) * inside_.array().square())) {
  problem_.rays->grow(level_.rays, progress);
  if (problem_.zones.cells) zones_.emplace(problem_.zones, bins_, level_.rays, level_.zones.weight);
}

void FreeFormFit::keep_other_light_of(const DesignShape& shape) {
  if (!problem_.other_light) return;
  const Eigen::VectorXd all = problem_.other_light(shape, bins_, level_.rays);
  // Beside the rectangle no shape makes it less, and all of it would hide what is left to gain: it is no more
  // there than what is wanted. Of a target that is given but for a factor that is what the start's light
  // makes of it.
  const double lit = inside_.dot(target_);
  const bool has_factor = problem_.mode == TargetMode::shape && problem_.flux_reference > 0.0 && lit > 0.0;
  const double factor = has_factor ? problem_.flux_reference / lit : 1.0;
  const Eigen::VectorXd wanted = factor * target_;
  other_light_ = all.cwiseMin(wanted) + (all - wanted).cwiseMax(0.0).cwiseProduct(inside_);
}

FreeFormPoint FreeFormFit::at(DesignShape shape, bool derivatives) const {
  EvaluationOptions options;
  options.rays = level_.rays;
  options.derivative_rays = level_.derivative_rays;
  options.direct_light = problem_.direct_light;
  options.rim_mm = kRimShare * shape.radius_mm();
  options.derivatives = options.sparse = derivatives;
  Evaluation light = evaluate(shape, problem_.reflectance, *problem_.rays, bins_, options);
  if (!derivatives) light.rows.resize(light.flux.size(), static_cast<Eigen::Index>(shape.parameter_count()));
  if (other_light_.size() > 0) light.flux += other_light_;
  SparseEquations equations = sparse_equations(light, target_, weights_, problem_.mode);
  equations *= error_weight();
  if (zones_) zones_->add_to(light, equations);
  ResidualRows rows;
  ResidualRows* const wanted = derivatives ? &rows : nullptr;
  equations.cost +=
      smoothness_penalty(shape, smoothing_for(shape, level_.smoothing), kSmoothnessAtAxis, wanted);
  equations.cost += problem_.limits_cost(shape, level_.rays, wanted);
  rows.add_to(equations);
  const double missing = missing_light(inside_.dot(light.flux), problem_.flux_reference);
  if (problem_.flux_weight > 0.0 && missing > 0.0) {
    Eigen::VectorXd slope = light.rows.transpose() * inside_ * (-1.0 / problem_.flux_reference);
    equations.cost += problem_.flux_weight * missing * missing;
    equations.gradient += problem_.flux_weight * missing * slope;
    equations.products.push_back({std::move(slope), problem_.flux_weight});
  }
  light.rows.resize(0, 0);
  return {std::move(shape), std::move(light), std::move(equations)};
}

Eigen::VectorXd FreeFormFit::move_within_limits(const FreeFormPoint& now,
                                                const SparseEquations& without_limits,
                                                const SparseSymmetric& metric, double lambda) const {
  Eigen::VectorXd move = damped_step(now.equations, metric, lambda);
  for (int i = 0; i < kLooksAhead && move.allFinite(); ++i) {
    ResidualRows there;
    const double cost = problem_.form->cost(now.shape.with(now.shape.parameters() + move), &there);
    if (cost <= kLittleCost * now.equations.cost) break;
    SparseEquations with = without_limits;
    there.before(move).add_to(with);
    move = damped_step(with, metric, lambda);
  }
  return move;
}

bool FreeFormFit::step(FreeFormPoint& now, double& lambda, bool doubtful) const {
  const Eigen::VectorXd from = now.shape.parameters();
  const double longest = kMaxMove * now.shape.radius_mm();
  const SparseSymmetric metric = sparse_step_metric(now.shape, now.equations);
  const auto at_move = [&](const Eigen::VectorXd& move) {
    DesignShape shape = now.shape.with(from + move);
    if (doubtful) {
      FreeFormPoint trial = at(shape, false);
      if (!(trial.equations.cost < now.equations.cost)) return trial;
    }
    return at(std::move(shape));
  };
  const auto tried = [&](const auto& move_of) {
    return levenberg_marquardt_step(now, move_of, lambda, longest, at_move);
  };
  LevenbergMarquardtStep step;
  if (problem_.form == nullptr) {
    step = tried([&](double damping) { return damped_step(now.equations, metric, damping); });
  } else {
    ResidualRows here;
    problem_.form->cost(now.shape, &here);
    SparseEquations without_limits = now.equations;
    here.take_from(without_limits);
    step = tried([&](double damping) { return move_within_limits(now, without_limits, metric, damping); });
  }
  lambda = step.next_lambda;
  return step.accepted;
}

BinError FreeFormFit::error(const FreeFormPoint& point) const {
  return bin_error(point.light, target_, weights_, problem_.mode);
}

}  // namespace lucerna
