// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

namespace lucerna {

/// Cholesky's factorisation in place: the lower triangle of `a`, symmetric, becomes L with L L^T = a, and
/// what lies above the diagonal is overwritten. By square tiles, which all threads share; Eigen's own runs on
/// one. False where `a` is not positive definite (then it is left half done). The same bits for any number of
/// threads. n^3 / 3 multiplications.
bool factorise_in_tiles(Eigen::MatrixXd& a);

/// Replaces each column b of `right` by the solution of L L^T x = b.
void solve_factorised(const Eigen::MatrixXd& l, Eigen::MatrixXd& right);

}  // namespace lucerna
