// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/sparse_equations.h"

#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/solver/tiled_cholesky.h"

namespace lucerna {

namespace {

/// Columns of a sparse matrix one after the other.
struct Columns {
  std::vector<int> count, row;
  std::vector<double> value;
};

SparseSymmetric joined(const std::vector<Columns>& parts, Eigen::Index n) {
  std::size_t total = 0;
  for (const Columns& c : parts) total += c.row.size();
  SparseSymmetric out(n, n);
  out.resizeNonZeros(static_cast<Eigen::Index>(total));
  int at = 0, column = 0;
  for (const Columns& c : parts) {
    std::copy(c.row.begin(), c.row.end(), out.innerIndexPtr() + at);
    std::copy(c.value.begin(), c.value.end(), out.valuePtr() + at);
    for (const int k : c.count) {
      out.outerIndexPtr()[column++] = at;
      at += k;
    }
  }
  out.outerIndexPtr()[column] = at;
  return out;
}

/// A matrix with more of its triangle filled is factorised as a dense one: a sparse factor fills up, and each
/// of its multiplications takes ten times as long (2601 parameters, two cores, 16 % filled: 1.0 s against
/// 0.45; 6 % filled: 0.18 s).
constexpr double kDenseShare = 0.13;

bool is_dense(const SparseSymmetric& a) {
  const auto n = static_cast<double>(a.rows());
  return static_cast<double>(a.nonZeros()) > kDenseShare * 0.5 * n * n;
}

/// a + weight b, of which the lower triangle counts.
Eigen::MatrixXd dense_sum(const SparseSymmetric& a, double weight, const SparseSymmetric& b) {
  Eigen::MatrixXd sum(a.rows(), a.cols());
  parallel_blocks(static_cast<std::size_t>(a.cols()), 16, [&](std::size_t first, std::size_t last) {
    for (auto c = static_cast<Eigen::Index>(first); c < static_cast<Eigen::Index>(last); ++c) {
      sum.col(c).setZero();
      for (SparseSymmetric::InnerIterator k(a, c); k; ++k) sum(k.row(), c) = k.value();
      for (SparseSymmetric::InnerIterator k(b, c); k; ++k) sum(k.row(), c) += weight * k.value();
    }
  });
  return sum;
}

/// (a + weight b)^-1 right by Cholesky's factorisation; NaN where the sum is not positive definite.
Eigen::MatrixXd solved(const SparseSymmetric& a, double weight, const SparseSymmetric& b,
                       Eigen::MatrixXd right) {
  if (is_dense(a)) {
    Eigen::MatrixXd l = dense_sum(a, weight, b);
    if (factorise_in_tiles(l)) {
      solve_factorised(l, right);
      return right;
    }
  } else {
    const Eigen::SimplicialLLT<SparseSymmetric, Eigen::Lower> solver(a + weight * b);
    if (solver.info() == Eigen::Success) return solver.solve(right);
  }
  return Eigen::MatrixXd::Constant(right.rows(), right.cols(), std::nan(""));
}

}  // namespace

SparseSymmetric squared_rows(const SparseJacobian& j) {
  const Eigen::SparseMatrix<double> by_column = j;
  const Eigen::Index n = j.cols();
  const auto columns_of = [&](std::size_t first, std::size_t last) {
    Columns out;
    std::vector<double> sum(static_cast<std::size_t>(n), 0.0);
    std::vector<char> seen(static_cast<std::size_t>(n), 0);
    for (auto p = static_cast<Eigen::Index>(first); p < static_cast<Eigen::Index>(last); ++p) {
      seen[static_cast<std::size_t>(p)] = 1;
      for (Eigen::SparseMatrix<double>::InnerIterator b(by_column, p); b; ++b) {
        const int begin = j.outerIndexPtr()[b.index()], end = j.outerIndexPtr()[b.index() + 1];
        const int* const row = j.innerIndexPtr();
        for (int k = static_cast<int>(std::lower_bound(row + begin, row + end, static_cast<int>(p)) - row);
             k < end; ++k) {
          const auto q = static_cast<std::size_t>(row[k]);
          seen[q] = 1;
          sum[q] += b.value() * j.valuePtr()[k];
        }
      }
      const std::size_t before = out.row.size();
      for (auto q = static_cast<std::size_t>(p); q < seen.size(); ++q) {
        if (seen[q] == 0) continue;
        out.row.push_back(static_cast<int>(q));
        out.value.push_back(sum[q]);
        sum[q] = 0.0;
        seen[q] = 0;
      }
      out.count.push_back(static_cast<int>(out.row.size() - before));
    }
    return out;
  };
  return joined(parallel_map_blocks<Columns>(static_cast<std::size_t>(n), 64, columns_of), n);
}

SparseEquations& SparseEquations::operator*=(double weight) {
  if (weight == 1.0) return *this;
  cost *= weight;
  gradient *= weight;
  hessian *= weight;
  for (Product& p : products) p.weight *= weight;
  return *this;
}

SparseEquations sparse_equations(const Evaluation& e, const Eigen::VectorXd& target, const Eigen::VectorXd& w,
                                 TargetMode mode) {
  const double norm = w.dot(target.cwiseAbs2());
  LUCERNA_CHECK(norm > 0.0, "a target without light in its window");
  const double scale = best_scale(e.flux, target, w, mode), unit = scale / std::sqrt(norm);
  const Eigen::VectorXd residual = (scale * e.flux - target) / std::sqrt(norm);
  SparseJacobian j = e.rows;  // of the weighted residuals
  for (Eigen::Index b = 0; b < j.rows(); ++b) {
    const double by = unit * std::sqrt(w[b]);
    for (SparseJacobian::InnerIterator k(j, b); k; ++k) k.valueRef() *= by;
  }
  const Eigen::VectorXd root = w.cwiseSqrt();
  SparseEquations out;
  out.cost = w.dot(residual.cwiseAbs2());
  out.gradient = j.transpose() * root.cwiseProduct(residual);
  out.hessian = squared_rows(j);
  if (e.rows_noise.size() > 0)
    out.derivative_noise = unit * unit * w.dot(e.rows_noise) / out.hessian.diagonal().sum();
  if (mode == TargetMode::shape) {  // what only scales the result is no improvement
    const Eigen::VectorXd flux = unit * root.cwiseProduct(e.flux);
    const double own = flux.squaredNorm();
    Eigen::VectorXd along = j.transpose() * flux;
    out.gradient -= along * (flux.dot(root.cwiseProduct(residual)) / own);
    out.products.push_back({std::move(along), -1.0 / own});
  }
  return out;
}

SparseSymmetric sparse_step_metric(const DesignShape& shape, const SparseEquations& equations) {
  const auto& spline = std::get<BsplineShape>(shape.family());
  const Eigen::VectorXd diagonal = equations.hessian.diagonal();
  const double mean = diagonal.mean();
  std::vector<Eigen::Triplet<double>> entries;
  for_each_tilt(spline, [&](int a, int b, double share) {
    const int i = shape.parameter_of()[static_cast<std::size_t>(a)];
    const int j = shape.parameter_of()[static_cast<std::size_t>(b)];
    if (i == j) return;
    entries.emplace_back(i, i, share * mean);
    entries.emplace_back(j, j, share * mean);
    entries.emplace_back(std::max(i, j), std::min(i, j), -share * mean);
  });
  const Eigen::VectorXd own = own_share(diagonal);
  for (Eigen::Index i = 0; i < own.size(); ++i) {
    entries.emplace_back(static_cast<int>(i), static_cast<int>(i), own[i]);
  }
  SparseSymmetric metric(own.size(), own.size());
  metric.setFromTriplets(entries.begin(), entries.end());
  return metric;
}

Eigen::VectorXd damped_step(const SparseEquations& equations, const SparseSymmetric& metric, double lambda) {
  const Eigen::Index n = metric.rows(), k = static_cast<Eigen::Index>(equations.products.size());
  Eigen::MatrixXd right(n, k + 1);
  right.col(0) = equations.gradient;
  for (Eigen::Index i = 0; i < k; ++i) right.col(i + 1) = equations.products[static_cast<std::size_t>(i)].v;
  const Eigen::MatrixXd x = solved(equations.hessian, lambda, metric, right);
  if (!x.allFinite()) return Eigen::VectorXd::Constant(n, std::nan(""));
  Eigen::VectorXd step = x.col(0);
  if (k > 0) {  // Woodbury
    Eigen::MatrixXd inner(k, k);
    Eigen::VectorXd of_gradient(k);
    for (Eigen::Index i = 0; i < k; ++i) {
      const SparseEquations::Product& p = equations.products[static_cast<std::size_t>(i)];
      for (Eigen::Index c = 0; c < k; ++c) inner(i, c) = p.v.dot(x.col(c + 1));
      inner(i, i) += 1.0 / p.weight;
      of_gradient[i] = p.v.dot(x.col(0));
    }
    step -= x.rightCols(k) * inner.fullPivLu().solve(of_gradient);
  }
  return -step;
}

double next_lambda(double lambda, const SparseEquations& equations, const Eigen::VectorXd& step,
                   double cost) {
  double curved = step.dot(equations.hessian.selfadjointView<Eigen::Lower>() * step);
  for (const SparseEquations::Product& p : equations.products)
    curved += p.weight * std::pow(p.v.dot(step), 2);
  return next_lambda(lambda, -(2.0 * equations.gradient.dot(step) + curved), equations.cost - cost);
}

}  // namespace lucerna
