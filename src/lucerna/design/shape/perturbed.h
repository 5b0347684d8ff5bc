// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/shape/design_shape.h"
#include "lucerna/random.h"

namespace lucerna {

/// A copy of a shape with every parameter moved at random, uniformly within +-`size_mm`, in their order.
inline DesignShape perturbed(const DesignShape& shape, double size_mm, Rng rng) {
  Eigen::VectorXd parameters = shape.parameters();
  for (double& p : parameters) p += size_mm * (2.0 * rng.uniform() - 1.0);
  return shape.with(parameters);
}

}  // namespace lucerna
