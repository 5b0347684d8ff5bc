// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/problem/target_mode.h"

namespace lucerna {

/// Comparison of an evaluation with a target in the same bins.
struct BinError {
  /// Root of the solid-angle-weighted sum of squared differences of intensity, over that of the target.
  double relative_rms = 0.0;
  /// What counting noise alone makes of it.
  double floor = 0.0;
  /// What the result was multiplied by (1 in absolute mode).
  double scale = 1.0;
};

/// `target` is flux per bin in the evaluation's unit (shares of the sources' flux). `weights`: what squared
/// differences of flux count, as bin_weights or a part of that.
BinError bin_error(const Evaluation& e, const Eigen::VectorXd& target, const Eigen::VectorXd& weights,
                   TargetMode mode);
BinError bin_error(const Evaluation& e, const Eigen::VectorXd& target, const TentBins& bins, TargetMode mode);

/// The normal equations of a least-squares step: cost = |r|^2 with gradient 2 g and Gauss-Newton Hessian 2 H.
struct NormalEquations {
  double cost = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd hessian;
};

/// Of the relative residuals r = (scale * F - T) / sqrt(Omega) / |T / sqrt(Omega)|, so that cost = relative
/// RMS^2. In shape mode the best scale is projected out (variable projection, Kaufman's approximation). The
/// evaluation must have derivatives. Summed in fixed blocks of bins: the same bits for any thread count.
NormalEquations normal_equations(const Evaluation& e, const Eigen::VectorXd& target, const TentBins& bins,
                                 TargetMode mode);

/// The step -(H + lambda D)^-1 g, D the diagonal of H and a little of its mean, so that parameters without
/// light stay where they are.
Eigen::VectorXd damped_step(const NormalEquations& equations, double lambda);
/// The same with another D, symmetric and positive definite.
Eigen::VectorXd damped_step(const NormalEquations& equations, const Eigen::MatrixXd& metric, double lambda);

/// How a step of a shape's parameters is measured. The linear model holds as far as light moves by about a
/// bin, and light moves with the mirror's slopes: of free forms D is the sum of squared differences of
/// neighbouring coefficients, with a little of their own squares. Smooth changes may be long then while
/// creases stay small. Of revolution D is the diagonal, as above.
Eigen::MatrixXd step_metric(const DesignShape& shape, const NormalEquations& equations);

/// What the squared difference of two neighbours counts in that metric, over the mean of the Hessian's
/// diagonal. Small, so that the first damping of a stage suits free forms and revolution.
inline constexpr double kTiltShare = 0.02;
/// What the two parts of that metric count: share(a, b) for each pair of neighbouring coefficients of a free
/// form, over the mean of the Hessian's diagonal; and each parameter's own square.
void for_each_tilt(const BsplineShape& spline, const std::function<void(int a, int b, double share)>& share);
Eigen::VectorXd own_share(const Eigen::VectorXd& diagonal);

/// 1 / measure per bin; 0 where a bin has none.
Eigen::VectorXd bin_weights(const TentBins& bins);
/// What a result is multiplied by before it is compared.
double best_scale(const Eigen::VectorXd& flux, const Eigen::VectorXd& target, const Eigen::VectorXd& weights,
                  TargetMode mode);

/// Damping beyond which there is no step to be had.
inline constexpr double kMaxLambda = 1e12;
/// The damping after a step from which the equations predicted one gain and which brought another.
double next_lambda(double lambda, double predicted, double gained);
/// The damping after a step that made the cost `cost`: Nielsen's rule, by how much of the gain that the
/// equations predicted came true. No jumps, so that a narrow valley is not left at every other step.
double next_lambda(double lambda, const NormalEquations& equations, const Eigen::VectorXd& step, double cost);

}  // namespace lucerna
