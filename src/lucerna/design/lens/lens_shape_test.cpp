// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/design/lens/lens_curves.h"

namespace lucerna {
namespace {

using Corners = std::vector<OutlinePoint>;
using Sides = std::vector<std::size_t>;

/// A flat bottom, a wall, and a cap of three sides.
const Corners kCap{{0, 3}, {9, 3}, {9, 5}, {6, 8}, {3, 9.5}, {0, 10}};

std::size_t parameters_of(const Corners& corners, const Sides& sides, int intervals) {
  return LensShape(corners, 30.0, sides, intervals).parameter_count();
}

TEST(LensShape, HasAParameterForEachCornerOfAFreeFace) {
  EXPECT_EQ(parameters_of(kCap, {2}, 0), 4u) << "edge, two within, axis";
  EXPECT_EQ(parameters_of(kCap, {4}, 0), 4u) << "any side of the face will do";
  EXPECT_EQ(parameters_of(kCap, {2}, 19), 20u);
  EXPECT_EQ(parameters_of(kCap, {0}, 0), static_cast<std::size_t>(kLensIntervals) + 1);
  EXPECT_EQ(parameters_of(kCap, {1, 2}, 5), 2u + 4u + 2u + 4u + 1u - 1u)
      << "an edge between free faces has two";
}

TEST(LensShape, BeginsWithTheGivenOutline) {
  const LensShape shape(kCap, 30.0, Sides{2}, 0);
  EXPECT_TRUE(shape.is_valid());
  EXPECT_EQ(shape.corners().size(), kCap.size());
  for (const OutlinePoint& p : kCap)
    EXPECT_NE(std::find(shape.corners().begin(), shape.corners().end(), p), shape.corners().end());
  EXPECT_DOUBLE_EQ(shape.height_mm(), 7.0);
  EXPECT_DOUBLE_EQ(shape.radius_mm(), 9.0);
}

// The same faces are free when the outline runs the other way round.
TEST(LensShape, DoesNotMindWhichWayTheOutlineRuns) {
  const Corners back(kCap.rbegin(), kCap.rend());
  for (std::size_t side = 0; side < 5; ++side) {
    // Side i of the reversed outline joins the corners of side n - 2 - i.
    const std::size_t other = (2 * kCap.size() - 2 - side) % kCap.size();
    EXPECT_EQ(parameters_of(kCap, {side}, 6), parameters_of(back, {other}, 6)) << side;
  }
}

TEST(LensShape, KeepsEdgesOnTheirWallsAndTheAxis) {
  const LensShape shape(kCap, 30.0, Sides{2}, 8);
  Eigen::VectorXd p = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(shape.parameter_count()), 0.1);
  const LensShape moved = shape.with(p);
  EXPECT_TRUE(moved.is_valid());
  int on_wall = 0, on_axis = 0;
  for (const OutlinePoint& c : moved.corners()) {
    on_wall += c[0] == 9.0 ? 1 : 0;
    on_axis += c[0] == 0.0 ? 1 : 0;
  }
  EXPECT_EQ(on_wall, 2);
  EXPECT_EQ(on_axis, 2);
}

TEST(LensShape, SaysWhereAnOutlineIsNoLens) {
  const LensShape shape(kCap, 30.0, Sides{2}, 8);
  const auto n = static_cast<Eigen::Index>(shape.parameter_count());
  EXPECT_FALSE(shape.with(Eigen::VectorXd::Constant(n, -9.0)).is_valid()) << "through the bottom";
  Eigen::VectorXd rough = Eigen::VectorXd::Zero(n);
  for (Eigen::Index i = 0; i < n; ++i) rough[i] = i % 2 == 0 ? 1.0 : -1.0;
  EXPECT_FALSE(shape.with(rough).is_valid()) << "edges within a face";
  EXPECT_THROW(LensShape(kCap, 30.0, Sides{6}, 8), InputError);
  EXPECT_THROW(LensShape(kCap, 30.0, Sides{5}, 8), InputError) << "the axis";
  EXPECT_THROW(LensShape(kCap, 30.0, Sides{}, 8), InputError);
}

// The numbers of the curve's pieces, through the spline and its chords, against differences.
TEST(LensCurves, NumbersHaveExactDerivatives) {
  const LensShape shape(kCap, 30.0, Sides{0, 2}, 7);
  const Eigen::MatrixXd jacobian = number_jacobian(shape);
  ASSERT_EQ(jacobian.rows(), 2 * 7 * kPieceNumbers);
  constexpr double kStep = 1e-5;
  const auto numbers = [&](Eigen::Index parameter, double step) {
    Eigen::VectorXd p = shape.parameters();
    p[parameter] += step;
    const LensCurves curves(shape.with(p));
    Eigen::VectorXd out(jacobian.rows());
    for (const LensPiece& piece : curves.pieces()) {
      if (piece.first_number < 0) continue;
      Eigen::Index at = piece.first_number;
      for (const auto* part :
           {&piece.curve.from, &piece.curve.to, &piece.curve.from_slope, &piece.curve.to_slope}) {
        for (const double x : *part) out[at++] = x;
      }
    }
    return out;
  };
  for (Eigen::Index p = 0; p < jacobian.cols(); ++p) {
    const Eigen::VectorXd difference = (numbers(p, kStep) - numbers(p, -kStep)) / (2.0 * kStep);
    EXPECT_LT((difference - jacobian.col(p)).cwiseAbs().maxCoeff(), 1e-7) << p;
  }
}

}  // namespace
}  // namespace lucerna
