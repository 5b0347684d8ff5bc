// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/least_squares.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Equations of n parameters that light tells of, with a gradient.
NormalEquations equations(Eigen::Index n) {
  Rng rng(4, 0);
  Eigen::MatrixXd j(2 * n, n);
  for (double& x : j.reshaped()) x = 2.0 * rng.uniform() - 1.0;
  NormalEquations e;
  e.hessian = j.transpose() * j;
  e.gradient = j.transpose() * Eigen::VectorXd::Ones(2 * n);
  return e;
}

double size(const Eigen::VectorXd& step, const Eigen::MatrixXd& metric) { return step.dot(metric * step); }

TEST(StepMetric, CountsTiltsOfAFreeFormMoreThanItsLift) {
  const DesignShape shape = DesignShape::bspline(15, Aperture::rectangle(100, 50), 6, 6);
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  const Eigen::MatrixXd metric = step_metric(shape, equations(n));
  EXPECT_EQ(metric, metric.transpose());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(metric).eigenvalues()[0], 0.0);
  Eigen::VectorXd lift = Eigen::VectorXd::Ones(n), along_x = lift, along_y = lift;
  for (Eigen::Index i = 0; i < n; ++i) {
    if (i % 9 % 2 == 1) along_x[i] = -1.0;
    if (i / 9 % 2 == 1) along_y[i] = -1.0;
  }
  EXPECT_GT(size(along_x, metric), 50.0 * size(lift, metric));
  // Cells are half as wide across y: the same heights are twice as steep.
  EXPECT_NEAR(size(along_y, metric) / size(along_x, metric), 4.0, 0.2);
}

TEST(StepMetric, TiesCoefficientsOfOneParameter) {
  for (const DesignShape& shape :
       {DesignShape::bspline(15, Aperture::rectangle(100, 100), 5, 6, ShapeSymmetry::both),
        DesignShape::trough(15, Aperture::rectangle(100, 100), 8, true)}) {
    const auto n = static_cast<Eigen::Index>(shape.parameter_count());
    const Eigen::MatrixXd metric = step_metric(shape, equations(n));
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(metric).eigenvalues()[0], 0.0);
    const Eigen::VectorXd lift = Eigen::VectorXd::Ones(n);
    EXPECT_LT(size(lift, metric), 0.01 * metric.trace());
  }
}

TEST(StepMetric, MoreDampingMakesShorterStepsDownhill) {
  for (const DesignShape& shape : {DesignShape::bspline(15, Aperture::rectangle(100, 100), 4, 4),
                                   DesignShape::revolution(15, Aperture::circle(100), 12)}) {
    const NormalEquations e = equations(static_cast<Eigen::Index>(shape.parameter_count()));
    const Eigen::MatrixXd metric = step_metric(shape, e);
    double last = 1e300;
    for (const double lambda : {1e-4, 1e-2, 1.0, 1e2, 1e4}) {
      const Eigen::VectorXd step = damped_step(e, metric, lambda);
      EXPECT_LT(e.gradient.dot(step), 0.0);
      EXPECT_LT(size(step, metric), last);
      last = size(step, metric);
    }
  }
}

}  // namespace
}  // namespace lucerna
