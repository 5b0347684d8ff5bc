// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/levenberg_marquardt.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"

namespace lucerna {
namespace {

struct QuadraticPoint {
  Eigen::VectorXd x;
  NormalEquations equations;
};

/// |J (x - minimum)|^2 + 1: its normal equations are exact.
struct Quadratic {
  Eigen::MatrixXd j;
  Eigen::VectorXd minimum;

  Quadratic(Eigen::Index n, std::uint64_t seed) : j(2 * n, n), minimum(n) {
    Rng rng(seed, 0);
    for (double& a : j.reshaped()) a = 2.0 * rng.uniform() - 1.0;
    for (double& a : minimum) a = 2.0 * rng.uniform() - 1.0;
  }
  QuadraticPoint at(const Eigen::VectorXd& x) const {
    const Eigen::VectorXd r = j * (x - minimum);
    return {x, {1.0 + r.squaredNorm(), j.transpose() * r, j.transpose() * j}};
  }
};

constexpr double kFar = 1e300;

template <class Surface>
LevenbergMarquardtStep step_on(const Surface& surface, QuadraticPoint& now, double lambda, double longest) {
  const Eigen::VectorXd from = now.x;
  const auto n = from.size();
  const Eigen::MatrixXd metric = Eigen::MatrixXd::Identity(n, n);
  return levenberg_marquardt_step(
      now, [&](double damping) { return damped_step(now.equations, metric, damping); }, lambda, longest,
      [&](const Eigen::VectorXd& move) { return surface.at(from + move); });
}

TEST(LevenbergMarquardt, OneStepReachesTheMinimumOfAQuadratic) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const Quadratic surface(static_cast<Eigen::Index>(seed), seed);
    QuadraticPoint now = surface.at(Eigen::VectorXd::Constant(surface.minimum.size(), 3.0));
    const LevenbergMarquardtStep step = step_on(surface, now, 1e-14, kFar);
    EXPECT_TRUE(step.accepted);
    EXPECT_NEAR(now.equations.cost, 1.0, 1e-12) << seed;
    EXPECT_LT((now.x - surface.minimum).cwiseAbs().maxCoeff(), 1e-8) << seed;
  }
}

TEST(LevenbergMarquardt, ShortStepsGetThereTooAndNeverUphill) {
  const Quadratic surface(6, 3);
  constexpr double kLongest = 0.1;
  QuadraticPoint now = surface.at(Eigen::VectorXd::Constant(6, 3.0));
  double lambda = 1e-2;
  for (int k = 0; k < 300; ++k) {
    const QuadraticPoint before = now;
    const LevenbergMarquardtStep step = step_on(surface, now, lambda, kLongest);
    EXPECT_LE(now.equations.cost, before.equations.cost);
    EXPECT_LE((now.x - before.x).cwiseAbs().maxCoeff(), kLongest);
    EXPECT_GE(step.tried_lambda, lambda);
    lambda = step.next_lambda;
  }
  EXPECT_NEAR(now.equations.cost, 1.0, 1e-9);
}

// Each step is as long as it may be; with Nielsen's rule alone every second damping is found too weak.
TEST(LevenbergMarquardt, NoStepAfterTheFirstIsTooLong) {
  const Quadratic surface(6, 3);
  constexpr double kLongest = 0.02;
  QuadraticPoint now = surface.at(Eigen::VectorXd::Constant(6, 3.0));
  double lambda = step_on(surface, now, 1e-2, kLongest).next_lambda;
  for (int k = 0; k < 50; ++k) {
    const LevenbergMarquardtStep step = step_on(surface, now, lambda, kLongest);
    ASSERT_TRUE(step.accepted) << k;
    EXPECT_EQ(step.tried_lambda, lambda) << k;
    lambda = step.next_lambda;
  }
}

TEST(LevenbergMarquardt, ARefusedStepChangesNothingButTheDamping) {
  // Wherever the step leads, the cost is higher.
  struct Rising {
    Quadratic truth{4, 5};
    QuadraticPoint at(const Eigen::VectorXd& x) const {
      QuadraticPoint p = truth.at(x);
      p.equations.cost = kFar;
      return p;
    }
  } const rising;
  QuadraticPoint now = rising.truth.at(Eigen::VectorXd::Zero(4));
  const QuadraticPoint before = now;
  const LevenbergMarquardtStep step = step_on(rising, now, 1e-2, kFar);
  EXPECT_FALSE(step.accepted);
  EXPECT_EQ(now.x, before.x);
  EXPECT_EQ(now.equations.cost, before.equations.cost);
  EXPECT_DOUBLE_EQ(step.next_lambda, 5.0 * step.tried_lambda);
}

TEST(LevenbergMarquardt, WithoutLightNothingIsEvaluated) {
  QuadraticPoint now{Eigen::VectorXd::Zero(3),
                     {1.0, Eigen::VectorXd::Constant(3, std::nan("")), Eigen::MatrixXd::Zero(3, 3)}};
  int evaluated = 0;
  const LevenbergMarquardtStep step = levenberg_marquardt_step(
      now,
      [&](double damping) {
        return damped_step(now.equations, Eigen::MatrixXd(Eigen::MatrixXd::Identity(3, 3)), damping);
      },
      1e-2, 1.0, [&](const Eigen::VectorXd&) { return ++evaluated, now; });
  EXPECT_FALSE(step.accepted);
  EXPECT_EQ(evaluated, 0);
  EXPECT_GE(step.tried_lambda, kMaxLambda);
}

}  // namespace
}  // namespace lucerna
