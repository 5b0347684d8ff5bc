// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/cumulative_flux.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr Eigen::Index kRings = 12, kParameters = 4;

/// Light that depends on the parameters p as F + J p + a little of their squares.
struct Model {
  Eigen::VectorXd flux = Eigen::VectorXd::Zero(kRings);
  BinJacobian jacobian = BinJacobian::Zero(kRings, kParameters);

  explicit Model(std::uint64_t seed) {
    Rng rng(seed, 0);
    for (double& x : flux) x = 0.5 + rng.uniform();
    for (Eigen::Index i = 0; i < kRings; ++i) {
      for (Eigen::Index k = 0; k < kParameters; ++k) jacobian(i, k) = rng.uniform() - 0.5;
    }
  }
  Evaluation at(const Eigen::VectorXd& p) const {
    Evaluation e;
    e.flux = flux + jacobian * p + 0.1 * p.squaredNorm() * Eigen::VectorXd::Ones(kRings);
    e.jacobian = jacobian + 0.2 * Eigen::VectorXd::Ones(kRings) * p.transpose();
    return e;
  }
};

NormalEquations equations_of(const Evaluation& e, const Eigen::VectorXd& target, TargetMode mode) {
  NormalEquations out;
  out.gradient = Eigen::VectorXd::Zero(e.jacobian.cols());
  out.hessian = Eigen::MatrixXd::Zero(e.jacobian.cols(), e.jacobian.cols());
  add_cumulative_flux(e, target, mode, 3.0, out);
  return out;
}

TEST(CumulativeFlux, GradientIsThatOfTheCost) {
  for (const TargetMode mode : {TargetMode::shape, TargetMode::absolute}) {
    const Model model(3);
    const Eigen::VectorXd target = Model(4).flux;
    Eigen::VectorXd p(kParameters);
    p << 0.1, -0.2, 0.3, 0.05;
    const NormalEquations here = equations_of(model.at(p), target, mode);
    for (Eigen::Index k = 0; k < kParameters; ++k) {
      constexpr double kStep = 1e-5;
      Eigen::VectorXd up = p, down = p;
      up[k] += kStep;
      down[k] -= kStep;
      const double slope =
          (equations_of(model.at(up), target, mode).cost - equations_of(model.at(down), target, mode).cost) /
          (2.0 * kStep);
      EXPECT_NEAR(2.0 * here.gradient[k], slope, 1e-7 + 1e-5 * std::abs(slope)) << k;
    }
  }
}

// What makes it lead from far away: light two rings off costs more than light one ring off.
TEST(CumulativeFlux, CostsMoreTheFartherLightIsFromItsRing) {
  Eigen::VectorXd target = Eigen::VectorXd::Zero(kRings);
  target[2] = 1.0;
  for (Eigen::Index ring = 2; ring < kRings; ++ring) {
    Evaluation e;
    e.flux = Eigen::VectorXd::Zero(kRings);
    e.flux[ring] = 1.0;
    e.jacobian = BinJacobian::Zero(kRings, kParameters);
    const double cost = equations_of(e, target, TargetMode::shape).cost;
    EXPECT_NEAR(cost, 3.0 * static_cast<double>(ring - 2) / static_cast<double>(kRings), 1e-12);
  }
}

TEST(CumulativeFlux, InShapeModeTheAmountDoesNotMatterAndNoLightIsRefused) {
  const Eigen::VectorXd target = Model(4).flux;
  Evaluation e = Model(3).at(Eigen::VectorXd::Zero(kParameters));
  const double cost = equations_of(e, target, TargetMode::shape).cost;
  e.flux *= 7.0;
  e.jacobian *= 7.0;
  EXPECT_NEAR(equations_of(e, target, TargetMode::shape).cost, cost, 1e-12);
  EXPECT_GT(equations_of(e, target, TargetMode::absolute).cost, 10.0 * cost);
  e.flux.setZero();
  EXPECT_TRUE(std::isinf(equations_of(e, target, TargetMode::shape).cost));
}

}  // namespace
}  // namespace lucerna
