// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/solver/least_squares.h"
#include "lucerna/design/solver/sparse_equations.h"

namespace lucerna {

/// Residuals beside those of the light (limits, smoothness): each r counts r^2 in the cost, and its
/// derivative has few entries or many. Parameters may repeat within a row.
class ResidualRows {
 public:
  void begin(double residual) { rows_.push_back({residual, index_.size()}); }
  void add(int parameter, double slope) {
    index_.push_back(parameter);
    slope_.push_back(slope);
  }

  bool empty() const { return rows_.empty(); }
  /// Adds gradients and Gauss-Newton Hessians; the cost is not touched.
  void add_to(NormalEquations& equations) const;
  void add_to(SparseEquations& equations) const { add_to(equations, 1.0); }
  /// Takes out again what was added.
  void take_from(SparseEquations& equations) const { add_to(equations, -1.0); }
  /// The same where the parameters were before `move`, as if residuals were linear in them.
  ResidualRows before(const Eigen::VectorXd& move) const;
  /// Adds J^T r: half the derivative of the cost.
  void add_gradient_to(Eigen::VectorXd& gradient) const;

 private:
  struct Row {
    double residual;
    std::size_t first;
  };
  void add_to(SparseEquations& equations, double weight) const;
  std::size_t end(std::size_t row) const {
    return row + 1 < rows_.size() ? rows_[row + 1].first : index_.size();
  }

  std::vector<Row> rows_;
  std::vector<int> index_;
  std::vector<double> slope_;
};

}  // namespace lucerna
