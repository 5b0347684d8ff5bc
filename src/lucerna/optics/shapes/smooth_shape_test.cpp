// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/smooth_shape.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/random.h"

namespace lucerna {
namespace {

/// Random coefficients, and one far out of line.
std::vector<double> with_a_spike(std::size_t n, std::size_t spike) {
  Rng rng(7, 0);
  std::vector<double> c(n);
  for (double& x : c) x = 0.1 * (2.0 * rng.uniform() - 1.0);
  c[spike] = 8.0;
  return c;
}

/// Second derivatives along random directions at random places, each against every bound that holds there.
template <class View>
void expect_bounded(const View& view, double half_mm) {
  Rng rng(11, 0);
  double largest_share = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const double x = half_mm * (2.0 * rng.uniform() - 1.0), y = half_mm * (2.0 * rng.uniform() - 1.0);
    const double angle = 6.3 * rng.uniform(), dx = std::cos(angle), dy = std::sin(angle);
    const auto at = view.local(x, y);
    const double base = 0.5 / view.focal_mm;
    const double second = dx * dx * (at.hxx - base) + 2.0 * dx * dy * at.hxy + dy * dy * (at.hyy - base);
    ASSERT_LE(std::abs(second), view.curvature_bound * (1.0 + 1e-9));
    for (int size = 0; size < kNearSizes; ++size) {
      // From a place as far away as the bound reaches.
      const double away = rng.uniform() * near_cells(size) * view.cell_mm(), turn = 6.3 * rng.uniform();
      const double from_x = x + away * std::cos(turn), from_y = y + away * std::sin(turn);
      if (std::abs(from_x) > half_mm || std::abs(from_y) > half_mm) continue;
      const double bound = view.near_curvatures_at(from_x, from_y)[size];
      ASSERT_LE(std::abs(second), bound * (1.0 + 1e-9)) << x << ' ' << y << ' ' << size;
      largest_share = std::max(largest_share, std::abs(second) / bound);
    }
  }
  EXPECT_GT(largest_share, 0.3);  // bounds that are far too large would cost time
}

TEST(SmoothShape, NearBendsHoldAndForgetAFarSpike) {
  const KnotRow row{-50.0, 100.0 / 12, 12};
  const BsplineShape shape(15.0, row, row, with_a_spike(std::size_t{15} * 15, std::size_t{15} * 12 + 12));
  const BsplineView view = shape.view();
  expect_bounded(view, 50.0);
  EXPECT_LT(view.near_curvatures_at(-30.0, -30.0)[0], 0.1 * view.curvature_bound);
  EXPECT_LT(view.near_curvatures_at(-30.0, -30.0)[1], 0.1 * view.curvature_bound);
  EXPECT_EQ(view.near_curvatures_at(45.0, 45.0)[0], view.curvature_bound);
}

TEST(SmoothShape, NearBendsOfAProfileKnowTheAxis) {
  // s' / r counts everything from the axis outward: a spike there is felt everywhere, one at the rim is not.
  const KnotRow row{0.0, 50.0 / 12, 12};
  std::vector<double> at_rim = with_a_spike(15, 13);
  at_rim[0] = at_rim[2];
  const RevolutionShape shape(15.0, row, at_rim);
  expect_bounded(shape.view(), 35.0);
  EXPECT_LT(shape.view().near_curvatures_at(5.0, 0.0)[1], 0.1 * shape.curvature_bound());
  std::vector<double> at_axis = with_a_spike(15, 1);
  at_axis[0] = at_axis[2];
  const RevolutionShape inner(15.0, row, at_axis);
  expect_bounded(inner.view(), 35.0);
  EXPECT_EQ(inner.view().near_curvatures_at(45.0, 0.0)[0], inner.curvature_bound());
}

}  // namespace
}  // namespace lucerna
