// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/cumulative_flux.h"

#include <limits>

namespace lucerna {

void add_cumulative_flux(const Evaluation& e, const Eigen::VectorXd& target, TargetMode mode, double weight,
                         NormalEquations& equations) {
  const double wanted = target.sum(), light = e.flux.sum();
  if (!(light > 0.0)) {
    equations.cost = std::numeric_limits<double>::infinity();
    return;
  }
  const bool scaled = mode == TargetMode::shape;
  const double scale = scaled ? wanted / light : 1.0;
  const Eigen::RowVectorXd by_light = scaled
                                          ? Eigen::RowVectorXd((1.0 / light) * e.jacobian.colwise().sum())
                                          : Eigen::RowVectorXd(Eigen::RowVectorXd::Zero(e.jacobian.cols()));
  const double share = weight / (static_cast<double>(target.size()) * wanted * wanted);
  double within = 0.0;
  Eigen::RowVectorXd slope = Eigen::RowVectorXd::Zero(e.jacobian.cols());
  for (Eigen::Index i = 0; i < target.size(); ++i) {
    within += scale * e.flux[i] - target[i];
    slope += scale * (e.jacobian.row(i) - e.flux[i] * by_light);
    equations.cost += share * within * within;
    equations.gradient += share * within * slope.transpose();
    equations.hessian += share * slope.transpose() * slope;
  }
}

}  // namespace lucerna
