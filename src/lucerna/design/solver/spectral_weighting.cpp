// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/spectral_weighting.h"

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The orthonormal cosine transform, mode by mode.
Eigen::MatrixXd cosines(int n) {
  Eigen::MatrixXd c(n, n);
  for (int k = 0; k < n; ++k) {
    const double norm = std::sqrt((k == 0 ? 1.0 : 2.0) / n);
    for (int i = 0; i < n; ++i) c(k, i) = norm * std::cos(std::numbers::pi * (i + 0.5) * k / n);
  }
  return c;
}

}  // namespace

SpectralWeighting::SpectralWeighting(const TentBins& bins, double cutoff)
    : root_(static_cast<Eigen::Index>(bins.size())) {
  const int n = bins.count();
  LUCERNA_CHECK(cutoff > 0.0 && bins.size() == static_cast<std::size_t>(n) * n, "bins in a square");
  const Eigen::MatrixXd c = cosines(n);
  Eigen::VectorXd weight(n);
  for (int k = 0; k < n; ++k) weight[k] = 1.0 / std::hypot(1.0, k / cutoff);
  axis_ = c.transpose() * weight.asDiagonal() * c;
  for (Eigen::Index i = 0; i < root_.size(); ++i) {
    root_[i] = std::sqrt(bins.measure()[static_cast<std::size_t>(i)]);
  }
}

Eigen::VectorXd SpectralWeighting::flux(const Eigen::VectorXd& flux) const { return jacobian(flux).col(0); }

BinJacobian SpectralWeighting::jacobian(const BinJacobian& jacobian) const {
  const Eigen::Index n = axis_.rows(), columns = jacobian.cols();
  // A bin without measure (beyond the horizon) has no weight in residuals either.
  const Eigen::VectorXd over = root_.unaryExpr([](double r) { return r > 0.0 ? 1.0 / r : 0.0; });
  const RowMajorMatrix density = over.asDiagonal() * jacobian;
  // Bins are rows of v, in them u, in them parameters: v all at once, then u row by row.
  const Eigen::Map<const RowMajorMatrix> by_v(density.data(), n, n * columns);
  const RowMajorMatrix across = axis_ * by_v;
  RowMajorMatrix both(n * n, columns);
  for (Eigen::Index j = 0; j < n; ++j) {
    const Eigen::Map<const RowMajorMatrix> row(across.data() + j * n * columns, n, columns);
    both.middleRows(j * n, n) = axis_ * row;
  }
  return root_.asDiagonal() * both;
}

Evaluation SpectralWeighting::operator()(Evaluation e) const {
  e.flux = flux(e.flux);
  if (e.jacobian.size() > 0) e.jacobian = jacobian(e.jacobian);
  return e;
}

}  // namespace lucerna
