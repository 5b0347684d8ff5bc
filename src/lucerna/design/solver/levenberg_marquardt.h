// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <utility>

#include "lucerna/design/solver/least_squares.h"

namespace lucerna {

/// What a step of Levenberg-Marquardt came to.
struct LevenbergMarquardtStep {
  bool accepted = false;
  /// Damping of the step that was tried, and of the next.
  double tried_lambda = 0.0, next_lambda = 0.0;
};

/// One step of Levenberg-Marquardt, without a state of its own. `now` has `equations` (normal or sparse),
/// `move_of(lambda)` is their damped step; damping begins at `lambda` and grows until no parameter moves by
/// more than `longest`. `at(move)` evaluates the point there. Where the cost falls, `now` moves and the
/// damping follows Nielsen's rule, but does not fall so far that the next step would be too long; else `now`
/// stays and the damping is five times as strong. Where no damping makes the step short enough (no light
/// tells of any parameter) nothing is evaluated.
template <class Point, class MoveOf, class PointAt>
LevenbergMarquardtStep levenberg_marquardt_step(Point& now, const MoveOf& move_of, double lambda,
                                                double longest, const PointAt& at) {
  constexpr double kRaise = 4.0, kRefused = 5.0;
  Eigen::VectorXd move = move_of(lambda);
  while (!(move.cwiseAbs().maxCoeff() <= longest)) {
    if (lambda >= kMaxLambda) return {false, lambda, kRefused * lambda};
    lambda *= kRaise;
    move = move_of(lambda);
  }
  Point trial = at(std::as_const(move));
  if (!(trial.equations.cost < now.equations.cost)) return {false, lambda, kRefused * lambda};
  // Weaker damping makes a step longer in proportion at most (in the metric's norm), so that the next one is
  // nearly always short enough at once.
  const double short_enough = lambda * move.cwiseAbs().maxCoeff() / longest;
  const double next = std::max(short_enough, next_lambda(lambda, now.equations, move, trial.equations.cost));
  now = std::move(trial);
  return {true, lambda, next};
}

}  // namespace lucerna
