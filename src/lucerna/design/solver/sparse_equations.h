// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <vector>

#include "lucerna/design/evaluation/evaluation.h"
#include "lucerna/design/solver/least_squares.h"

namespace lucerna {

/// Lower triangle of a symmetric matrix.
using SparseSymmetric = Eigen::SparseMatrix<double>;

/// The normal equations of a least-squares step of many parameters: cost = |r|^2, gradient 2 g, Gauss-Newton
/// Hessian 2 (H + sum of weight v v^T). Terms that join all parameters (the free scale of shape mode, the
/// light in the window) are kept as single products, so that H stays sparse.
struct SparseEquations {
  struct Product {
    Eigen::VectorXd v;
    double weight;
  };
  double cost = 0.0;
  Eigen::VectorXd gradient;
  SparseSymmetric hessian;
  std::vector<Product> products;
  /// Share of the trace of the light's J^T J that is noise of the rays (0 where it is not known). Where it is
  /// large, noise damps what little light tells of, and no smaller lambda helps.
  double derivative_noise = 0.0;

  SparseEquations& operator*=(double weight);
};

/// Lower triangle of J^T J.
SparseSymmetric squared_rows(const SparseJacobian& j);

/// As `normal_equations`, from an evaluation with `rows`; `weights` as bin_error has them. Throws never; the
/// same bits for any thread count.
SparseEquations sparse_equations(const Evaluation& e, const Eigen::VectorXd& target,
                                 const Eigen::VectorXd& weights, TargetMode mode);

/// How a step of a free form is measured: see `step_metric`.
SparseSymmetric sparse_step_metric(const DesignShape& shape, const SparseEquations& equations);

/// The step -(H + lambda D + products)^-1 g by Cholesky factorisation, sparse where H is.
Eigen::VectorXd damped_step(const SparseEquations& equations, const SparseSymmetric& metric, double lambda);

/// See least_squares.h.
double next_lambda(double lambda, const SparseEquations& equations, const Eigen::VectorXd& step, double cost);

}  // namespace lucerna
