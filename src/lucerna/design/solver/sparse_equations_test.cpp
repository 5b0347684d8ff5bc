// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/solver/sparse_equations.h"

#include <gtest/gtest.h>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/fit/graded_bins.h"
#include "lucerna/design/solver/residual_rows.h"
#include "lucerna/random.h"
#include "lucerna/source.h"

namespace lucerna {
namespace {

struct SparseScene {
  DesignRays rays;
  DesignShape shape;
  TentBins bins;
};

DesignShape bumpy(ShapeSymmetry symmetry) {
  const DesignShape plain = DesignShape::bspline(15, Aperture::circle(100, 8), 12, 9, symmetry);
  Rng rng(5, 0);
  Eigen::VectorXd p = plain.parameters();
  for (double& x : p) x = 0.4 * (2.0 * rng.uniform() - 1.0);
  return plain.with(p);
}

SparseScene scene(ShapeSymmetry symmetry = ShapeSymmetry::none) {
  EmitterOptions options;
  options.kind = EmitterKind::cylinder;
  PlacedSource source{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 15}), {}};
  DesignRays rays({source}, Frame(), 7);
  rays.grow(1 << 20);
  return {std::move(rays), bumpy(symmetry),
          graded_bins({Frame(), false, -0.3, 0.4, -0.2, 0.2}, Frame(), 32, 1.25, 4)};
}

Evaluation evaluated(const SparseScene& s, bool sparse, std::uint64_t rays = 1 << 16) {
  EvaluationOptions options;
  options.rays = rays;
  options.sparse = sparse;
  options.rim_mm = 1.0;
  return evaluate(s.shape, Reflectance(0.9), s.rays, s.bins, options);
}

TEST(SparseJacobian, IsTheDenseOne) {
  for (const ShapeSymmetry symmetry : {ShapeSymmetry::none, ShapeSymmetry::both}) {
    const SparseScene s = scene(symmetry);
    const Evaluation dense = evaluated(s, false), sparse = evaluated(s, true);
    EXPECT_EQ(sparse.jacobian.size(), 0);
    ASSERT_EQ(sparse.rows.cols(), dense.jacobian.cols());
    EXPECT_EQ(sparse.flux, dense.flux);
    const Eigen::MatrixXd off = Eigen::MatrixXd(sparse.rows) - Eigen::MatrixXd(dense.jacobian);
    EXPECT_LT(off.norm(), 1e-12 * dense.jacobian.norm());
    EXPECT_LT(sparse.rows.nonZeros(), dense.jacobian.size());
  }
}

TEST(SparseJacobian, HasTheSameBitsForAnyNumberOfThreads) {
  const SparseScene s = scene();
  const Evaluation many = evaluated(s, true);
  const ThreadLimit limit(1);
  const Evaluation one = evaluated(s, true);
  ASSERT_EQ(one.rows.nonZeros(), many.rows.nonZeros());
  for (Eigen::Index i = 0; i < one.rows.nonZeros(); ++i) {
    ASSERT_EQ(one.rows.valuePtr()[i], many.rows.valuePtr()[i]);
    ASSERT_EQ(one.rows.innerIndexPtr()[i], many.rows.innerIndexPtr()[i]);
  }
}

// The light of all rays, and the derivatives that the first of them have alone.
TEST(SparseJacobian, MayBeThatOfFewerRays) {
  const SparseScene s = scene();
  EvaluationOptions options;
  options.rays = 1 << 18;
  options.derivative_rays = 1 << 16;
  options.sparse = true;
  options.rim_mm = 1.0;
  const Evaluation both = evaluate(s.shape, Reflectance(0.9), s.rays, s.bins, options);
  const Evaluation few = evaluated(s, true), all = evaluated(s, true, options.rays);
  EXPECT_EQ(both.flux, all.flux);
  EXPECT_EQ(both.variance, all.variance);
  EXPECT_EQ(both.reflected, all.reflected);
  EXPECT_EQ(Eigen::MatrixXd(both.rows), Eigen::MatrixXd(few.rows));
  EXPECT_EQ(both.rows_noise, few.rows_noise);
  options.derivative_rays = 1;  // a block of each task at least
  EXPECT_GT(evaluate(s.shape, Reflectance(0.9), s.rays, s.bins, options).rows.norm(), 0.0);
}

// What the scatter of the rays adds to the squared rows: with it few rays have 1.4 times what sixteen times
// the rays have. The scatter of the parts states up to half too much, for their rays are parts of one even
// sequence.
TEST(SparseJacobian, SaysWhatNoiseAddsToItsSquare) {
  const SparseScene s = scene();
  const auto square = [](const Evaluation& e) { return e.rows.squaredNorm(); };
  const Evaluation few = evaluated(s, true), many = evaluated(s, true, 1 << 20);
  const double truth = square(many) - many.rows_noise.sum();
  const double added = square(few) - truth, stated = few.rows_noise.sum();
  EXPECT_GT(added, 0.3 * truth);
  EXPECT_GT(stated, 0.9 * added);
  EXPECT_LT(stated, 1.6 * added);
  EXPECT_NEAR(stated, 16.0 * many.rows_noise.sum(), 0.25 * stated);

  const Eigen::VectorXd target =
      Eigen::Map<const Eigen::VectorXd>(s.bins.measure().data(), static_cast<Eigen::Index>(s.bins.size()));
  const auto share = [&](const Evaluation& e) {
    return sparse_equations(e, target, bin_weights(s.bins), TargetMode::absolute).derivative_noise;
  };
  EXPECT_GT(share(few), 6.0 * share(many));
  EXPECT_LT(share(few), 1.0);
}

TEST(SparseEquations, AreTheDenseOnesAndTakeTheSameStep) {
  const SparseScene s = scene();
  const Evaluation dense_light = evaluated(s, false), sparse_light = evaluated(s, true);
  const Eigen::VectorXd target =
      Eigen::Map<const Eigen::VectorXd>(s.bins.measure().data(), static_cast<Eigen::Index>(s.bins.size()));
  for (const TargetMode mode : {TargetMode::shape, TargetMode::absolute}) {
    const NormalEquations dense = normal_equations(dense_light, target, s.bins, mode);
    const SparseEquations sparse = sparse_equations(sparse_light, target, bin_weights(s.bins), mode);
    EXPECT_NEAR(sparse.cost, dense.cost, 1e-12 * dense.cost);
    EXPECT_LT((sparse.gradient - dense.gradient).norm(), 1e-10 * dense.gradient.norm());
    Eigen::MatrixXd hessian = Eigen::MatrixXd(sparse.hessian).selfadjointView<Eigen::Lower>();
    for (const SparseEquations::Product& p : sparse.products) hessian += p.weight * p.v * p.v.transpose();
    const Eigen::MatrixXd full = dense.hessian.selfadjointView<Eigen::Lower>();
    EXPECT_LT((hessian - full).norm(), 1e-10 * full.norm());
    // The same damping in both, for the metric follows from a Hessian with or without its products.
    const SparseSymmetric metric = sparse_step_metric(s.shape, sparse);
    const Eigen::MatrixXd dense_metric = Eigen::MatrixXd(metric).selfadjointView<Eigen::Lower>();
    const Eigen::VectorXd a = damped_step(sparse, metric, 1e-3), b = damped_step(dense, dense_metric, 1e-3);
    EXPECT_LT((a - b).norm(), 1e-6 * b.norm());
    EXPECT_NEAR(next_lambda(1e-3, sparse, a, 0.9 * sparse.cost),
                next_lambda(1e-3, dense, b, 0.9 * dense.cost), 1e-9);
  }
}

/// Residuals of which `joining` reach all parameters, and each one parameter twice.
ResidualRows random_rows(int parameters, int count, int joining) {
  ResidualRows rows;
  Rng rng(9, 0);
  for (int r = 0; r < count; ++r) {
    rows.begin(rng.uniform());
    const int entries = r < joining ? parameters : 3;
    for (int i = 0; i < entries; ++i) rows.add((r + 7 * i) % parameters, rng.uniform() - 0.5);
    rows.add(r % parameters, 0.25);
  }
  return rows;
}

// Few rows that reach all parameters stay products; thousands of them, as a limit on the height of a mirror
// makes, must not: each step would solve a dense system of that size.
TEST(ResidualRows, CountTheSameInBothKindsOfEquations) {
  constexpr int kParameters = 40;
  for (const int joining : {0, 3, 16, 17, 500}) {
    const ResidualRows rows = random_rows(kParameters, joining + 30, joining);
    NormalEquations dense{0.0, Eigen::VectorXd::Zero(kParameters),
                          Eigen::MatrixXd::Zero(kParameters, kParameters)};
    SparseEquations sparse;
    sparse.gradient = Eigen::VectorXd::Zero(kParameters);
    sparse.hessian.resize(kParameters, kParameters);
    rows.add_to(dense);
    rows.add_to(sparse);
    EXPECT_EQ(sparse.products.size(), joining <= 16 ? static_cast<std::size_t>(joining) : 0u);
    EXPECT_LT((sparse.gradient - dense.gradient).norm(), 1e-12 * dense.gradient.norm());
    Eigen::MatrixXd hessian = Eigen::MatrixXd(sparse.hessian).selfadjointView<Eigen::Lower>();
    for (const SparseEquations::Product& p : sparse.products) hessian += p.weight * p.v * p.v.transpose();
    const Eigen::MatrixXd full = dense.hessian.selfadjointView<Eigen::Lower>();
    EXPECT_LT((hessian - full).norm(), 1e-12 * full.norm());
  }
}

TEST(ResidualRows, AreTakenOutAgain) {
  constexpr int kParameters = 40;
  for (const int joining : {0, 3, 500}) {
    SparseEquations sparse;
    sparse.gradient = Eigen::VectorXd::Zero(kParameters);
    sparse.hessian.resize(kParameters, kParameters);
    const ResidualRows rows = random_rows(kParameters, joining + 30, joining);
    rows.add_to(sparse);
    const double size = sparse.gradient.norm() + sparse.hessian.norm();
    rows.take_from(sparse);
    EXPECT_LT(sparse.gradient.norm(), 1e-12 * size);
    EXPECT_LT(sparse.hessian.norm(), 1e-12 * size);
    Eigen::MatrixXd left = Eigen::MatrixXd::Zero(kParameters, kParameters);
    for (const SparseEquations::Product& p : sparse.products) left += p.weight * p.v * p.v.transpose();
    EXPECT_LT(left.norm(), 1e-12 * size);
  }
}

// (x - 1)^2 and (2 x + y)^2 at (3, 1), from what they are a move of (1, -2) farther on.
TEST(ResidualRows, AreLinearAlongAMove) {
  ResidualRows there;
  there.begin(3.0);
  there.add(0, 1.0);
  there.begin(7.0);
  there.add(0, 2.0);
  there.add(1, 1.0);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(2);
  there.before(Eigen::Vector2d(1.0, -2.0)).add_gradient_to(gradient);
  EXPECT_EQ(gradient, Eigen::Vector2d(2.0 * 1.0 + 7.0 * 2.0, 7.0));
}

}  // namespace
}  // namespace lucerna
