// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/missing_light.h"

namespace lucerna {

void add_missing_light(const Evaluation& e, double weight, double reference, NormalEquations& equations) {
  const double missing = missing_light(e.flux.sum(), reference);
  if (missing == 0.0) return;
  const Eigen::VectorXd slope = e.jacobian.colwise().sum().transpose() * (-1.0 / reference);
  equations.cost += weight * missing * missing;
  equations.gradient += weight * missing * slope;
  equations.hessian.selfadjointView<Eigen::Lower>().rankUpdate(slope, weight);
}

}  // namespace lucerna
