// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/residual_rows.h"

namespace lucerna {

void ResidualRows::add_to(NormalEquations& equations) const {
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    for (std::size_t i = rows_[row].first; i < end(row); ++i) {
      equations.gradient[index_[i]] += rows_[row].residual * slope_[i];
      for (std::size_t k = rows_[row].first; k < end(row); ++k) {
        if (index_[k] <= index_[i]) equations.hessian(index_[i], index_[k]) += slope_[i] * slope_[k];
      }
    }
  }
}

void ResidualRows::add_to(SparseEquations& equations) const {
  // A row of many parameters would fill the Hessian: it stays a product.
  const auto many = static_cast<std::size_t>(equations.gradient.size() / 8);
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t row = 0; row < rows_.size(); ++row) {
    const std::size_t first = rows_[row].first, last = end(row);
    Eigen::VectorXd dense;
    if (last - first > many) dense = Eigen::VectorXd::Zero(equations.gradient.size());
    for (std::size_t i = first; i < last; ++i) {
      equations.gradient[index_[i]] += rows_[row].residual * slope_[i];
      if (dense.size() > 0) {
        dense[index_[i]] += slope_[i];
        continue;
      }
      for (std::size_t k = first; k < last; ++k) {
        if (index_[k] <= index_[i]) entries.emplace_back(index_[i], index_[k], slope_[i] * slope_[k]);
      }
    }
    if (dense.size() > 0) equations.products.push_back({std::move(dense), 1.0});
  }
  if (entries.empty()) return;
  SparseSymmetric sum(equations.gradient.size(), equations.gradient.size());
  sum.setFromTriplets(entries.begin(), entries.end());
  equations.hessian += sum;
}

}  // namespace lucerna
