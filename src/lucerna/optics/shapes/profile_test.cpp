// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/profile.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

TEST(ConicProfile, ParabolaIsTheParabola) {
  const auto p = ConicProfile::parabola(15.0, 50.0);
  for (const double r : {0.0, 1.0, 17.3, 50.0}) {
    EXPECT_NEAR(p.at(r).z_mm, r * r / 60.0, 1e-13);
    EXPECT_NEAR(p.at(r).slope, r / 30.0, 1e-14);
  }
}

// Every point of an ellipse has the same sum of distances to the foci, of a hyperbola the same difference.
TEST(ConicProfile, DistancesToTheFociAreConstant) {
  const double f1 = 10.0, f2 = 90.0;
  const auto ellipse = ConicProfile::ellipse(f1, f2, 29.0);
  const auto hyperbola = ConicProfile::hyperbola(f1, f2, 80.0);
  for (double r = 0.0; r <= 29.0; r += 1.7) {
    const double z = ellipse.at(r).z_mm;
    EXPECT_NEAR(std::hypot(r, z - f1) + std::hypot(r, z - f2), f1 + f2, 1e-11);
  }
  for (double r = 0.0; r <= 80.0; r += 3.1) {
    const double z = hyperbola.at(r).z_mm;
    EXPECT_NEAR(std::hypot(r, z + f2) - std::hypot(r, z - f1), f2 - f1, 1e-11);
  }
}

TEST(ConicProfile, RefusesWhatIsNoProfile) {
  EXPECT_THROW(ConicProfile::parabola(-1.0, 10.0), InputError);
  EXPECT_THROW(ConicProfile::ellipse(10.0, 90.0, 30.0), InputError);
  EXPECT_THROW(ConicProfile::hyperbola(10.0, 9.0, 30.0), InputError);
}

TEST(SplineProfile, PassesThroughItsPointsWithContinuousCurvature) {
  const std::vector<ProfileKnot> knots{{0.0, 0.0}, {5.0, 0.6}, {9.0, 1.0}, {20.0, 8.0}, {31.0, 12.0}};
  const SplineProfile p(knots);
  EXPECT_EQ(p.at(0.0).slope, 0.0);
  const double e = 1e-5;
  for (std::size_t i = 0; i < knots.size(); ++i) EXPECT_NEAR(p.at(knots[i].r_mm).z_mm, knots[i].z_mm, 1e-13);
  for (std::size_t i = 1; i + 1 < knots.size(); ++i) {
    const double r = knots[i].r_mm, s = p.at(r).slope;
    EXPECT_NEAR((s - p.at(r - e).slope) / e, (p.at(r + e).slope - s) / e, 1e-5) << "curvature at knot " << i;
  }
}

TEST(SplineProfile, ReproducesACubicFromANotAKnotStart) {
  const auto cubic = [](double r) { return 1.0 + r * (0.5 + r * (-0.1 + 0.02 * r)); };
  std::vector<ProfileKnot> knots;
  for (const double r : {1.0, 2.0, 4.5, 6.0, 9.0}) knots.push_back({r, cubic(r)});
  const SplineProfile p(knots);
  for (double r = 1.0; r <= 9.0; r += 0.1) EXPECT_NEAR(p.at(r).z_mm, cubic(r), 1e-12);
}

TEST(SplineProfile, FewPointsMakeALineOrAParabola) {
  EXPECT_NEAR(SplineProfile({{1.0, 1.0}, {3.0, 2.0}}).at(2.0).z_mm, 1.5, 1e-15);
  EXPECT_NEAR(SplineProfile({{0.0, 1.0}, {2.0, 5.0}}).at(1.0).z_mm, 2.0, 1e-15);
  const SplineProfile three({{1.0, 1.0}, {2.0, 4.0}, {4.0, 16.0}});
  EXPECT_NEAR(three.at(3.0).z_mm, 9.0, 1e-13);
  const SplineProfile flat_three({{0.0, 0.0}, {2.0, 4.0}, {4.0, 16.0}});
  EXPECT_NEAR(flat_three.at(3.0).z_mm, 9.0, 1e-13);
}

// The range of heights must hold every point of the interval and be reached by some.
TEST(SplineProfile, RangeIsExact) {
  const SplineProfile p({{2.0, 0.0}, {5.0, 3.0}, {7.0, -1.0}, {11.0, 2.0}, {12.0, 0.0}});
  Rng rng(3, 1);
  for (int i = 0; i < 300; ++i) {
    const double a = 14.0 * rng.uniform(), b = a + (14.0 - a) * rng.uniform();
    const HeightRange range = p.range(a, b);
    double low = 1e9, high = -1e9;
    for (int k = 0; k <= 2000; ++k) {
      const double z = p.at(a + (b - a) * k / 2000.0).z_mm;
      low = std::min(low, z);
      high = std::max(high, z);
    }
    EXPECT_LE(range.low_mm, low + 1e-12);
    EXPECT_GE(range.high_mm, high - 1e-12);
    EXPECT_NEAR(range.low_mm, low, 1e-4);
    EXPECT_NEAR(range.high_mm, high, 1e-4);
  }
}

TEST(SplineProfile, RefusesBadPoints) {
  EXPECT_THROW(SplineProfile({{0.0, 0.0}}), InputError);
  EXPECT_THROW(SplineProfile({{0.0, 0.0}, {0.0, 1.0}}), InputError);
  EXPECT_THROW(SplineProfile({{-1.0, 0.0}, {2.0, 1.0}}), InputError);
  EXPECT_THROW(SplineProfile({{0.0, 0.0}, {1.0, std::nan("")}}), InputError);
}

TEST(Profile, IsConvexWhereItsSlopeNeverFalls) {
  EXPECT_TRUE(ConicProfile::parabola(15.0, 50.0).convex());
  EXPECT_TRUE(ConicProfile::ellipse(10.0, 90.0, 29.0).convex());
  EXPECT_TRUE(SplineProfile({{0.0, 0.0}, {5.0, 0.5}, {10.0, 2.2}, {20.0, 9.0}}).convex());
  EXPECT_TRUE(SplineProfile({{5.0, 0.5}, {10.0, 2.2}, {20.0, 9.0}}).convex());
  EXPECT_FALSE(SplineProfile({{0.0, 0.0}, {5.0, 0.6}, {9.0, 1.0}, {20.0, 8.0}, {31.0, 12.0}}).convex());
  EXPECT_FALSE(SplineProfile({{5.0, 9.0}, {10.0, 2.2}, {20.0, 0.5}}).convex())
      << "falls: a dome about the axis";
}

}  // namespace
}  // namespace lucerna
