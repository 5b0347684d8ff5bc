// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "lucerna/design/fit/fit_problem.h"
#include "lucerna/design/fit/graded_bins.h"
#include "lucerna/design/solver/sparse_equations.h"
#include "lucerna/progress.h"

namespace lucerna {

/// How finely a free form is fitted.
struct FreeFormLevel {
  int intervals_x = 32, intervals_y = 32;
  /// Bins across the target's rectangle widened by `widen`: finer than what a result is evaluated by, so that
  /// no ripple hides in them.
  int bins = 64;
  double widen = 1.25;
  std::uint64_t rays = std::uint64_t{1} << 18;
  /// EvaluationOptions::derivative_rays.
  std::uint64_t derivative_rays = 0;
  int max_steps = 6;
  /// Two accepted steps that gained less than this share of the error end the level.
  double min_gain = 0.02;
  /// Weight of `smoothness_penalty`.
  double smoothing = 0.0;
  /// How zones count.
  ZoneStage zones;
};

/// A shape with its light, and the equations of the next step.
struct FreeFormPoint {
  DesignShape shape;
  Evaluation light;
  SparseEquations equations;
};

/// Levenberg-Marquardt on a free form of many knots in fine bins that see all light, with sparse derivatives.
/// The cost is the squared relative error, what the limits, the zones and the roughness cost, and flux_weight
/// times the square of what the light in the target's rectangle lacks of flux_reference.
class FreeFormFit {
 public:
  /// `problem` must outlive it. Grows the problem's rays to the level's.
  FreeFormFit(const FitProblem& problem, const FreeFormLevel& level, Progress& progress = no_progress());

  /// From now on points have `FitProblem::other_light` of this shape.
  void keep_other_light_of(const DesignShape& shape);

  /// Without derivatives its equations have a cost only, in a third of the time.
  FreeFormPoint at(DesignShape shape, bool derivatives = true) const;

  /// Tries one step from `now`, which moves there if the cost falls; adapts the damping. True if it moved. A
  /// step that may well be refused (`doubtful`) is tried without derivatives first.
  bool step(FreeFormPoint& now, double& lambda, bool doubtful = false) const;

  const TentBins& bins() const { return bins_; }
  /// Error and noise of a point in these bins.
  BinError error(const FreeFormPoint& point) const;
  /// What the squared error counts.
  double error_weight() const { return problem_.zones.only ? level_.zones.guide_weight : 1.0; }
  /// Share of the sources' flux in the target's rectangle.
  double in_rectangle(const FreeFormPoint& point) const { return inside_.dot(point.light.flux); }

 private:
  /// The damped step of the equations at `now`. Limits on the form that it would break are taken into the
  /// linear model: their costs are nothing at `now` and very steep beyond. `without_limits`: the equations
  /// without those limits.
  Eigen::VectorXd move_within_limits(const FreeFormPoint& now, const SparseEquations& without_limits,
                                     const SparseSymmetric& metric, double lambda) const;

  const FitProblem& problem_;
  FreeFormLevel level_;
  TentBins bins_;
  Eigen::VectorXd target_, inside_, weights_;
  Eigen::VectorXd other_light_;  ///< empty: none
  std::optional<ZoneCost> zones_;
};

}  // namespace lucerna
