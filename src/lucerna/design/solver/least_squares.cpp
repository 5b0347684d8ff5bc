// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <variant>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"

namespace lucerna {

namespace {

/// What heights count in `step_metric` beside kTiltShare.
constexpr double kHeightShare = 2e-4;

}  // namespace

Eigen::VectorXd bin_weights(const TentBins& bins) {
  Eigen::VectorXd w(static_cast<Eigen::Index>(bins.size()));
  for (Eigen::Index i = 0; i < w.size(); ++i) {
    const double measure = bins.measure()[static_cast<std::size_t>(i)];
    w[i] = measure > 0.0 ? 1.0 / measure : 0.0;
  }
  return w;
}

double best_scale(const Eigen::VectorXd& flux, const Eigen::VectorXd& target, const Eigen::VectorXd& w,
                  TargetMode mode) {
  if (mode == TargetMode::absolute) return 1.0;
  const double own = w.dot(flux.cwiseAbs2());
  return own > 0.0 ? w.dot(flux.cwiseProduct(target)) / own : 1.0;
}

BinError bin_error(const Evaluation& e, const Eigen::VectorXd& target, const TentBins& bins,
                   TargetMode mode) {
  return bin_error(e, target, bin_weights(bins), mode);
}

BinError bin_error(const Evaluation& e, const Eigen::VectorXd& target, const Eigen::VectorXd& w,
                   TargetMode mode) {
  BinError error;
  error.scale = best_scale(e.flux, target, w, mode);
  const double norm = w.dot(target.cwiseAbs2());
  LUCERNA_CHECK(norm > 0.0, "a target without light in its window");
  error.relative_rms = std::sqrt(w.dot((error.scale * e.flux - target).cwiseAbs2()) / norm);
  error.floor = error.scale * std::sqrt(w.dot(e.variance) / norm);
  return error;
}

NormalEquations normal_equations(const Evaluation& e, const Eigen::VectorXd& target, const TentBins& bins,
                                 TargetMode mode) {
  const Eigen::VectorXd w = bin_weights(bins);
  const double norm = w.dot(target.cwiseAbs2());
  LUCERNA_CHECK(norm > 0.0, "a target without light in its window");
  const double scale = best_scale(e.flux, target, w, mode);
  const Eigen::VectorXd residual = scale * e.flux - target;
  const Eigen::Index n = e.jacobian.cols();

  struct Part {
    Eigen::VectorXd g, f;
    Eigen::MatrixXd h;
  };
  constexpr std::size_t kRows = 288;
  const auto parts = parallel_map_blocks<Part>(bins.size(), kRows, [&](std::size_t first, std::size_t last) {
    const auto row = static_cast<Eigen::Index>(first), rows = static_cast<Eigen::Index>(last - first);
    const Eigen::VectorXd root = w.segment(row, rows).cwiseSqrt();
    const Eigen::MatrixXd j = root.asDiagonal() * e.jacobian.middleRows(row, rows);
    Part p;
    p.h = Eigen::MatrixXd::Zero(n, n);
    p.h.selfadjointView<Eigen::Lower>().rankUpdate(j.transpose());
    p.g = j.transpose() * root.cwiseProduct(residual.segment(row, rows));
    p.f = j.transpose() * root.cwiseProduct(e.flux.segment(row, rows));
    return p;
  });
  NormalEquations out;
  out.cost = w.dot(residual.cwiseAbs2()) / norm;
  out.gradient = Eigen::VectorXd::Zero(n);
  out.hessian = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd along = Eigen::VectorXd::Zero(n);
  for (const Part& p : parts) {
    out.gradient += p.g;
    along += p.f;
    out.hessian += p.h;
  }
  if (mode == TargetMode::shape) {  // what only scales the result is no improvement
    const double own = w.dot(e.flux.cwiseAbs2());
    out.gradient -= along * (w.dot(e.flux.cwiseProduct(residual)) / own);
    out.hessian.selfadjointView<Eigen::Lower>().rankUpdate(along, -1.0 / own);
  }
  out.gradient *= scale / norm;
  out.hessian *= scale * scale / norm;
  return out;
}

namespace {

/// What each parameter's own square counts in a step: the Hessian's diagonal, and a little of its mean.
Eigen::VectorXd own_squares(const NormalEquations& equations) {
  const Eigen::VectorXd diagonal = equations.hessian.diagonal();
  return diagonal.array() + 1e-2 * diagonal.mean() + 1e-300;
}

}  // namespace

void for_each_tilt(const BsplineShape& spline, const std::function<void(int, int, double)>& share) {
  const int nx = spline.row_x().coefficients(), ny = spline.row_y().coefficients();
  const double step = std::min(spline.row_x().step_mm, spline.row_y().step_mm);
  const double in_x = kTiltShare * std::pow(step / spline.row_x().step_mm, 2);
  const double in_y = kTiltShare * std::pow(step / spline.row_y().step_mm, 2);
  for (int v = 0; v < ny; ++v) {
    for (int u = 0; u < nx; ++u) {
      const int at = v * nx + u;
      if (u + 1 < nx) share(at, at + 1, in_x);
      if (v + 1 < ny) share(at, at + nx, in_y);
    }
  }
}

Eigen::VectorXd own_share(const Eigen::VectorXd& diagonal) {
  return kHeightShare * (diagonal.array() + 1e-2 * diagonal.mean() + 1e-300);
}

Eigen::MatrixXd step_metric(const DesignShape& shape, const NormalEquations& equations) {
  const auto* const spline = std::get_if<BsplineShape>(&shape.family());
  if (spline == nullptr) return own_squares(equations).asDiagonal();
  const double mean = equations.hessian.diagonal().mean();
  Eigen::MatrixXd metric = own_share(equations.hessian.diagonal()).asDiagonal();
  for_each_tilt(*spline, [&](int a, int b, double share) {
    const auto i = shape.parameter_of()[static_cast<std::size_t>(a)];
    const auto j = shape.parameter_of()[static_cast<std::size_t>(b)];
    metric(i, i) += share * mean;
    metric(j, j) += share * mean;
    metric(i, j) -= share * mean;
    metric(j, i) -= share * mean;
  });
  return metric;
}

Eigen::VectorXd damped_step(const NormalEquations& equations, const Eigen::MatrixXd& metric, double lambda) {
  const Eigen::LDLT<Eigen::MatrixXd, Eigen::Lower> solver(equations.hessian + lambda * metric);
  return -solver.solve(equations.gradient);
}

Eigen::VectorXd damped_step(const NormalEquations& equations, double lambda) {
  return damped_step(equations, own_squares(equations).asDiagonal(), lambda);
}

double next_lambda(double lambda, double predicted, double gained) {
  return std::max(1e-7, lambda * std::max(0.2, 1.0 - std::pow(2.0 * gained / predicted - 1.0, 3)));
}

double next_lambda(double lambda, const NormalEquations& equations, const Eigen::VectorXd& step,
                   double cost) {
  const double predicted = -(equations.gradient.dot(step) * 2.0 +
                             step.dot(equations.hessian.selfadjointView<Eigen::Lower>() * step));
  return next_lambda(lambda, predicted, equations.cost - cost);
}

}  // namespace lucerna
