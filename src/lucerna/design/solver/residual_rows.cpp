// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

void ResidualRows::add_gradient_to(Eigen::VectorXd& gradient) const {
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (std::size_t i = rows_[row].first; i < end(row); ++i)
      gradient[index_[i]] += rows_[row].residual * slope_[i];
  }
}

void ResidualRows::add_to(NormalEquations& equations) const {
  add_gradient_to(equations.gradient);
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (std::size_t i = rows_[row].first; i < end(row); ++i) {
      for (std::size_t k = rows_[row].first; k < end(row); ++k) {
        if (index_[k] <= index_[i]) equations.hessian(index_[i], index_[k]) += slope_[i] * slope_[k];
      }
    }
  }
}

ResidualRows ResidualRows::before(const Eigen::VectorXd& move) const {
  ResidualRows out = *this;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (std::size_t i = rows_[row].first; i < end(row); ++i)
      out.rows_[row].residual -= slope_[i] * move[index_[i]];
  }
  return out;
}

void ResidualRows::add_to(SparseEquations& equations, double weight) const {
  // A row of many parameters would fill the Hessian, so it stays a product. Each product costs a step one
  // more solution, and all of them a dense system: when a limit on the height makes thousands, filling is
  // cheaper.
  constexpr std::size_t kMaxProducts = 16;
  const Eigen::Index n = equations.gradient.size();
  const auto is_product = [&](std::size_t row) {
    return end(row) - rows_[row].first > static_cast<std::size_t>(n / 8);
  };
  std::size_t joining = 0;
  for (std::size_t row = 0; row < rows_.size(); ++row) joining += is_product(row) ? 1 : 0;
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(n);
  add_gradient_to(gradient);
  equations.gradient += weight * gradient;
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    Eigen::VectorXd dense;
    if (joining <= kMaxProducts && is_product(row)) dense = Eigen::VectorXd::Zero(n);
    for (std::size_t i = rows_[row].first; i < end(row); ++i) {
      if (dense.size() > 0) {
        dense[index_[i]] += slope_[i];
      } else {
        entries.emplace_back(static_cast<int>(row), index_[i], slope_[i]);
      }
    }
    if (dense.size() > 0) equations.products.push_back({std::move(dense), weight});
  }
  SparseJacobian jacobian(static_cast<Eigen::Index>(rows_.size()), n);
  jacobian.setFromTriplets(entries.begin(), entries.end());
  equations.hessian += weight * squared_rows(jacobian);
}

}  // namespace lucerna
