// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/smoothness_penalty.h"

#include <gtest/gtest.h>

#include "lucerna/random.h"

namespace lucerna {
namespace {

NormalEquations nothing(const DesignShape& shape) {
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  return {0.0, Eigen::VectorXd::Zero(n), Eigen::MatrixXd::Zero(n, n)};
}

DesignShape rough_shape(const DesignShape& shape) {
  Eigen::VectorXd p = shape.parameters();
  Rng rng(3, 0);
  for (double& x : p) x += rng.uniform();
  return shape.with(p);
}

TEST(SmoothnessPenalty, ParaboloidsAreSmoothAndShakenShapesAreNot) {
  const DesignShape shapes[] = {DesignShape::revolution(10, Aperture::circle(40), 6),
                                DesignShape::bspline(10, Aperture::rectangle(40, 30), 5, 3),
                                DesignShape::bspline(10, Aperture::circle(40), 4, 4, ShapeSymmetry::both)};
  for (const DesignShape& shape : shapes) {
    const DesignShape wider =
        shape.through([&](double x, double y) { return shape.at(x, y).z_mm + 0.01 * (x * x + y * y); });
    EXPECT_NEAR(smoothness_penalty(wider, 1.0, 1.0, nullptr), 0.0, 1e-18);
    EXPECT_GT(smoothness_penalty(rough_shape(shape), 1.0, 1.0, nullptr), 1e-3);
  }
}

TEST(SmoothnessPenalty, CountsLessNearTheAxis) {
  const DesignShape flat = DesignShape::bspline(10, Aperture::circle(40), 12, 12);
  const auto bent = [&](std::size_t i, std::size_t j) {
    Eigen::VectorXd p = flat.parameters();
    p[static_cast<Eigen::Index>(j * 15 + i)] += 0.1;
    return flat.with(p);
  };
  const DesignShape near = bent(7, 7), far = bent(7, 11);
  EXPECT_NEAR(smoothness_penalty(near, 1.0, 1.0, nullptr), smoothness_penalty(far, 1.0, 1.0, nullptr), 1e-9);
  EXPECT_LT(smoothness_penalty(near, 1.0, 0.02, nullptr), 0.1 * smoothness_penalty(far, 1.0, 0.02, nullptr));
}

/// It is quadratic in the parameters: gradient and Hessian give its values exactly.
TEST(SmoothnessPenalty, GradientAndHessianAreThoseOfTheCost) {
  const DesignShape shape =
      rough_shape(DesignShape::bspline(10, Aperture::circle(40), 4, 4, ShapeSymmetry::both));
  NormalEquations equations = nothing(shape);
  ResidualRows rows;
  const double here = smoothness_penalty(shape, 0.5, 0.1, &rows);
  rows.add_to(equations);
  Eigen::VectorXd move(equations.gradient.size());
  Rng rng(4, 0);
  for (double& x : move) x = rng.uniform() - 0.5;
  const double there = smoothness_penalty(shape.with(shape.parameters() + move), 0.5, 0.1, nullptr);
  EXPECT_NEAR(there,
              here + 2.0 * equations.gradient.dot(move) +
                  move.dot(equations.hessian.selfadjointView<Eigen::Lower>() * move),
              1e-9 * there);
}

}  // namespace
}  // namespace lucerna
