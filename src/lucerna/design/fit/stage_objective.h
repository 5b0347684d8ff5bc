// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/design/fit/continuation_schedule.h"
#include "lucerna/design/fit/fit_problem.h"
#include "lucerna/design/solver/levenberg_marquardt.h"
#include "lucerna/design/solver/spectral_weighting.h"
#include "lucerna/progress.h"

namespace lucerna {

/// A shape with its light, and the equations of the next step.
struct FitPoint {
  DesignShape shape;
  Evaluation light;
  NormalEquations equations;
};

/// What a stage of a fit minimises: the squared relative error in the stage's bins (its large scales, where
/// the stage says so), and what roughness, limits and lost light cost.
class StageObjective {
 public:
  /// `problem` must outlive it. Grows the problem's rays to the stage's.
  StageObjective(const FitProblem& problem, const FitStage& stage, Progress& progress = no_progress());

  FitPoint at(DesignShape shape) const;
  /// One step of Levenberg-Marquardt from `now`.
  LevenbergMarquardtStep step(FitPoint& now, double lambda) const;
  /// Error and noise of a point in the stage's bins.
  BinError error(const FitPoint& point) const;
  /// Whether the cost is at the noise of the stage's rays: nothing is left to learn that more rays would not
  /// teach better.
  bool at_noise(const FitPoint& point) const;

 private:
  NormalEquations equations(const DesignShape& shape, const Evaluation& light) const;

  const FitProblem& problem_;
  FitStage stage_;
  TentBins bins_;
  Eigen::VectorXd target_;
  std::optional<SpectralWeighting> scale_;
};

}  // namespace lucerna
