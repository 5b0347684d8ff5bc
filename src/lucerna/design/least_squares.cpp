// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/least_squares.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <variant>

#include "lucerna/core/error.h"
#include "lucerna/core/parallel.h"

namespace lucerna {

namespace {

/// Of a free form's step, what tilts and heights count in `step_metric`, over the mean of the Hessian's
/// diagonal: small, so that the first damping of a stage suits both families.
constexpr double kTiltShare = 0.02, kHeightShare = 2e-4;

/// 1 / measure per bin; 0 where a bin has none.
Eigen::VectorXd weights(const TentBins& bins) {
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

}  // namespace

BinError bin_error(const Evaluation& e, const Eigen::VectorXd& target, const TentBins& bins,
                   TargetMode mode) {
  const Eigen::VectorXd w = weights(bins);
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
  const Eigen::VectorXd w = weights(bins);
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

Eigen::MatrixXd step_metric(const DesignShape& shape, const NormalEquations& equations) {
  const Eigen::VectorXd own = own_squares(equations);
  const double mean = equations.hessian.diagonal().mean();
  const auto* const spline = std::get_if<BsplineShape>(&shape.family());
  if (spline == nullptr) return own.asDiagonal();
  const int nx = spline->row_x().coefficients(), ny = spline->row_y().coefficients();
  const double step = std::min(spline->row_x().step_mm, spline->row_y().step_mm);
  Eigen::MatrixXd metric = Eigen::MatrixXd::Zero(own.size(), own.size());
  const auto tilt = [&](int a, int b, double step_mm) {
    const double w = kTiltShare * mean * (step / step_mm) * (step / step_mm);
    const auto i = shape.parameter_of()[static_cast<std::size_t>(a)];
    const auto j = shape.parameter_of()[static_cast<std::size_t>(b)];
    metric(i, i) += w;
    metric(j, j) += w;
    metric(i, j) -= w;
    metric(j, i) -= w;
  };
  for (int v = 0; v < ny; ++v) {
    for (int u = 0; u < nx; ++u) {
      const int at = v * nx + u;
      if (u + 1 < nx) tilt(at, at + 1, spline->row_x().step_mm);
      if (v + 1 < ny) tilt(at, at + nx, spline->row_y().step_mm);
    }
  }
  metric.diagonal() += kHeightShare * own;
  return metric;
}

Eigen::VectorXd damped_step(const NormalEquations& equations, const Eigen::MatrixXd& metric, double lambda) {
  const Eigen::LDLT<Eigen::MatrixXd, Eigen::Lower> solver(equations.hessian + lambda * metric);
  return -solver.solve(equations.gradient);
}

Eigen::VectorXd damped_step(const NormalEquations& equations, double lambda) {
  return damped_step(equations, own_squares(equations).asDiagonal(), lambda);
}

double next_lambda(double lambda, const NormalEquations& equations, const Eigen::VectorXd& step,
                   double cost) {
  const double predicted = -(equations.gradient.dot(step) * 2.0 +
                             step.dot(equations.hessian.selfadjointView<Eigen::Lower>() * step));
  const double gain = (equations.cost - cost) / predicted;
  return std::max(1e-7, lambda * std::max(0.2, 1.0 - std::pow(2.0 * gain - 1.0, 3)));
}

}  // namespace lucerna
