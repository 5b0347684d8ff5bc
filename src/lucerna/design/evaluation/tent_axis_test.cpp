// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/tent_axis.h"

#include <gtest/gtest.h>

namespace lucerna {
namespace {

TEST(TentAxis, IndexAndCoordinateAreInversesWithTheSlopesTheyState) {
  const TentAxis axis = tent_axis(-0.1, 0.3, 40, 8, -1.0, 1.0);
  EXPECT_EQ(axis.count(), 56);
  double before = -2.0;
  for (double index = -0.5; index <= axis.count() + 0.5; index += 0.125) {
    double du = 0.0, per = 0.0, unused = 0.0;
    const double u = axis.coordinate(index, du);
    EXPECT_GT(u, before);
    EXPECT_NEAR(axis.index(u, per), index, 1e-9);
    EXPECT_NEAR(du * per, 1.0, 1e-9);
    constexpr double kStep = 1e-6;
    EXPECT_NEAR((axis.index(u + kStep, unused) - axis.index(u - kStep, unused)) / (2.0 * kStep), per,
                1e-3 * per);
    before = u;
  }
}

TEST(TentAxis, ReachesAsFarAsItIsToldWithCellsThatGrow) {
  const TentAxis axis = tent_axis(-0.1, 0.3, 40, 8, -1.0, 1.0);
  double first = 0.0, last = 0.0, slope = 0.0;
  EXPECT_NEAR(axis.coordinate(0.0, first), -1.0, 1e-12);
  EXPECT_NEAR(axis.coordinate(56.0, last), 1.0, 1e-12);
  EXPECT_GT(first, 5.0 * axis.cell);
  axis.coordinate(8.0 - 1e-9, slope);
  EXPECT_NEAR(slope, axis.cell, 1e-6) << "no jump at the window's edge";
}

TEST(TentAxis, HasNarrowCellsWhereLittleIsLeftBeyond) {
  const TentAxis axis = tent_axis(-0.99, 0.99, 100, 8, -1.0, 1.0);
  double slope = 0.0;
  EXPECT_NEAR(axis.coordinate(0.0, slope), -1.0, 1e-12);
  EXPECT_NEAR(slope, 0.01 / 8, 1e-12);
}

}  // namespace
}  // namespace lucerna
