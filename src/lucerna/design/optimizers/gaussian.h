// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>

#include "lucerna/random.h"

namespace lucerna {

/// Standard normal numbers (Box-Muller, one of each pair).
inline double gaussian(Rng& rng) {
  const double u = 1.0 - rng.uniform(), v = rng.uniform();
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}
inline Eigen::VectorXd gaussian_vector(Rng& rng, Eigen::Index n) {
  Eigen::VectorXd x(n);
  for (double& v : x) v = gaussian(rng);
  return x;
}
/// Uniform in [-1, 1]^n.
inline Eigen::VectorXd uniform_vector(Rng& rng, Eigen::Index n) {
  Eigen::VectorXd x(n);
  for (double& v : x) v = 2.0 * rng.uniform() - 1.0;
  return x;
}

}  // namespace lucerna
