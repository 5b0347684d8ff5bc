// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/spline_surface.h"

#include <gtest/gtest.h>

#include <vector>

#include "lucerna/optics/shapes/profile.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

constexpr Rectangle kSquare{-30.0, 30.0, -20.0, 40.0};

/// Coefficients of a bowl, each moved by up to `rough_mm` to either side.
SplineSurface rough_bowl(double rough_mm, std::uint64_t seed) {
  Rng rng(seed, 0);
  std::vector<double> c;
  for (int j = 0; j < 9; ++j) {
    for (int i = 0; i < 9; ++i) {
      const double x = 10.0 * (i - 4), y = 10.0 * (j - 3);
      c.push_back((x * x + x * y + y * y) / 50.0 + rough_mm * (2.0 * rng.uniform() - 1.0));
    }
  }
  return {kSquare, 9, 9, c};
}

// A function is convex if none of its chords has a middle below it. All chords that end in a region which is
// said to be convex are within it.
TEST(SplineSurface, NoChordOfAConvexRegionIsBelowIt) {
  int convex = 0, not_convex = 0;
  for (std::uint64_t seed = 1; seed <= 300; ++seed) {
    const SplineSurface s = rough_bowl(static_cast<double>(seed) / 150.0, seed);
    Rng rng(seed, 1);
    const double x = 40.0 * rng.uniform() - 30.0, y = 40.0 * rng.uniform() - 20.0;
    const Rectangle region{x, x + 20.0 * rng.uniform(), y, y + 20.0 * rng.uniform()};
    if (!s.convex_over(region)) {
      ++not_convex;
      continue;
    }
    ++convex;
    const auto in = [&](double a, double b) { return a + (b - a) * rng.uniform(); };
    for (int k = 0; k < 500; ++k) {
      const double x0 = in(region.x0_mm, region.x1_mm), x1 = in(region.x0_mm, region.x1_mm);
      const double y0 = in(region.y0_mm, region.y1_mm), y1 = in(region.y0_mm, region.y1_mm);
      ASSERT_LE(s.at(0.5 * (x0 + x1), 0.5 * (y0 + y1)).z_mm,
                0.5 * (s.at(x0, y0).z_mm + s.at(x1, y1).z_mm) + 1e-12)
          << seed;
    }
  }
  EXPECT_GT(convex, 50);
  EXPECT_GT(not_convex, 50);
}

TEST(SplineSurface, IsConvexWhereItsPatchesAre) {
  EXPECT_TRUE(rough_bowl(0.0, 1).convex_over(kSquare));
  EXPECT_FALSE(rough_bowl(0.0, 1).convex_over({-30.0, 30.1, -20.0, 40.0})) << "beyond its rectangle";
  std::vector<double> saddle, level(81, 0.0);
  for (int j = 0; j < 9; ++j) {
    for (int i = 0; i < 9; ++i) saddle.push_back(0.1 * i * i - 0.01 * j * j);
  }
  EXPECT_FALSE(SplineSurface(kSquare, 9, 9, saddle).convex_over(kSquare));
  level[40] = 1.0;
  const SplineSurface bump(kSquare, 9, 9, level);
  EXPECT_FALSE(bump.convex_over(kSquare));
  EXPECT_TRUE(bump.convex_over({-30.0, -21.0, -20.0, -11.0})) << "the bump does not reach so far";
  const auto dome = std::make_shared<RevolutionSurface>(
      std::make_shared<SplineProfile>(std::vector<ProfileKnot>{{0.0, 9.0}, {50.0, 1.0}}));
  EXPECT_FALSE(SplineSurface(kSquare, 9, 9, std::vector<double>(81, 0.0), dome).convex_over(kSquare));
}

}  // namespace
}  // namespace lucerna
