// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/missing_light.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

NormalEquations of_light(double a, double b, double reference) {
  Evaluation light;
  light.flux = Eigen::Vector2d(a, b);
  light.jacobian = Eigen::Matrix2d{{0.3, 0.1}, {-0.1, 0.2}};
  NormalEquations out;
  out.gradient = Eigen::VectorXd::Zero(2);
  out.hessian = Eigen::MatrixXd::Zero(2, 2);
  add_missing_light(light, 0.5, reference, out);
  return out;
}

// 0.6 of 0.8: a quarter is missing; the light rises by 0.2 and 0.3 with the parameters.
TEST(MissingLight, CostsItsSquare) {
  const NormalEquations found = of_light(0.25, 0.35, 0.8);
  EXPECT_NEAR(found.cost, 0.5 * 0.0625, 1e-15);
  EXPECT_NEAR(found.gradient[0], -0.5 * 0.25 * 0.2 / 0.8, 1e-15);
  EXPECT_NEAR(found.gradient[1], -0.5 * 0.25 * 0.3 / 0.8, 1e-15);
  EXPECT_NEAR(found.hessian(1, 0), 0.5 * 0.2 * 0.3 / 0.64, 1e-15);
}

TEST(MissingLight, MoreThanTheReferenceIsNotTooMuch) {
  EXPECT_EQ(missing_light(0.9, 0.8), 0.0);
  EXPECT_EQ(missing_light(0.8, 0.8), 0.0);
  const NormalEquations found = of_light(0.5, 0.4, 0.8);
  EXPECT_EQ(found.cost, 0.0);
  EXPECT_EQ(found.gradient.norm(), 0.0);
  EXPECT_EQ(found.hessian.norm(), 0.0);
}

}  // namespace
}  // namespace lucerna
