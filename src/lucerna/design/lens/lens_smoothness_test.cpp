// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_smoothness.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

namespace lucerna {
namespace {

/// A flat bottom, a wall, and a cap that is free, in `pieces`; or the bottom free too.
LensShape cap(int pieces, const std::vector<std::size_t>& free_sides = {2}) {
  const std::vector<OutlinePoint> corners{{0, 3}, {9, 3}, {9, 5}, {6, 8}, {3, 9.5}, {0, 10}};
  return {corners, 30.0, free_sides, pieces};
}

/// Displacements along the normals of the cap by a function of the share of its corners from the edge on. The
/// edge slides along the wall, and so it is no corner of the wave.
Eigen::VectorXd displaced(const LensShape& shape, const std::function<double(double)>& height_mm) {
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  Eigen::VectorXd p(n);
  for (Eigen::Index i = 0; i < n; ++i) p[i] = height_mm(static_cast<double>(i) / static_cast<double>(n - 1));
  return p;
}

double roughness(const LensShape& shape, const Eigen::VectorXd& p) {
  return p.dot(lens_roughness(shape) * p);
}

TEST(LensSmoothness, RoughnessIsTheIntegralOfTheThirdDerivativeForAnyPieces) {
  // sin(2 pi x) of 1 mm on a radius of 9 mm: (2 pi)^6 / 2 / 81.
  const double expected = std::pow(2.0 * std::numbers::pi, 6) / 2.0 / 81.0;
  const auto wave = [](double x) { return std::sin(2.0 * std::numbers::pi * x); };
  for (const int pieces : {48, 96}) {
    const LensShape shape = cap(pieces);
    EXPECT_NEAR(roughness(shape, displaced(shape, wave)), expected, 0.1 * expected) << pieces;
  }
}

TEST(LensSmoothness, RoughnessIsNeverNegativeAndSeesZigzags) {
  const LensShape shape = cap(12, {0, 2});
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(lens_roughness(shape));
  EXPECT_GE(solver.eigenvalues().minCoeff(), -1e-9 * solver.eigenvalues().maxCoeff());
  const LensShape one = cap(12);
  const auto smooth = displaced(one, [](double x) { return 0.1 * std::cos(std::numbers::pi * x); });
  const auto zigzag = displaced(one, [](double x) { return std::lround(12.0 * x) % 2 == 0 ? 0.1 : -0.1; });
  EXPECT_GT(roughness(one, zigzag), 100.0 * roughness(one, smooth));
}

// Corners within a face move along its normals: each is in two differences, the one on the axis in one.
TEST(LensSmoothness, TiltIsTheSumOfSquaredDifferencesOfNeighbours) {
  const LensShape shape = cap(12);
  const Eigen::MatrixXd tilt = lens_tilt(shape);
  const Eigen::Index n = tilt.rows();
  ASSERT_EQ(n, static_cast<Eigen::Index>(shape.parameter_count()));
  EXPECT_TRUE(tilt.isApprox(tilt.transpose()));
  for (Eigen::Index i = 1; i < n - 1; ++i) {
    EXPECT_NEAR(tilt(i, i), 2.0, 1e-9) << i;
    EXPECT_NEAR(tilt(i, i + 1), -1.0, 1e-9) << i;
  }
  EXPECT_NEAR(tilt(n - 1, n - 1), 1.0, 1e-9);
  EXPECT_TRUE(tilt.topRightCorner(n - 2, n - 2).triangularView<Eigen::Upper>().toDenseMatrix().isZero(1e-12));
}

TEST(LensSmoothness, FacesOfFewCornersHaveNone) {
  EXPECT_TRUE(lens_roughness(cap(2)).isZero(0.0));
  EXPECT_FALSE(lens_roughness(cap(3)).isZero(0.0));
}

TEST(LensSmoothness, PerturbedLensesAreValidDifferentAndNearlyAsSmooth) {
  const LensShape shape = cap(19);
  const double size = 0.3;
  Eigen::VectorXd before = shape.parameters();
  for (std::uint64_t k = 0; k < 20; ++k) {
    const LensShape other = perturbed_smoothly(shape, size, Rng(5, k));
    ASSERT_TRUE(other.is_valid()) << k;
    EXPECT_EQ(other.corners(), perturbed_smoothly(shape, size, Rng(5, k)).corners()) << "the arguments alone";
    EXPECT_GT((other.parameters() - before).norm(), 1e-3) << k;
    EXPECT_LT(other.parameters().cwiseAbs().maxCoeff(), 5.0 * size) << k;
    before = other.parameters();
    // White noise of the same size is rougher.
    Rng rng(6, k);
    Eigen::VectorXd noise = before;
    for (double& x : noise) x = before.cwiseAbs().mean() * 2.0 * (2.0 * rng.uniform() - 1.0);
    EXPECT_LT(roughness(shape, before), 0.5 * roughness(shape, noise)) << k;
  }
}

TEST(LensSmoothness, AllFreeFacesArePerturbed) {
  const LensShape shape = cap(8, {0, 2});
  const LensShape other = perturbed_smoothly(shape, 0.2, Rng(5, 1));
  const auto& a = shape.corners();
  const auto& b = other.corners();
  int moved = 0;
  for (std::size_t i = 0; i < a.size(); ++i) moved += a[i] != b[i] ? 1 : 0;
  EXPECT_GE(moved, static_cast<int>(shape.parameter_count()) - 2);
}

}  // namespace
}  // namespace lucerna
