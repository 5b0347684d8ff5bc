// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/problem/target_rectangle.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/design/problem/target.h"

namespace lucerna {
namespace {

/// Intensity by a function of the direction, in a table of half a degree by two.
template <class F>
IntensityDistribution distribution(const F& intensity) {
  IntensityDistribution d = uniform_distribution(2.0, 0.5);
  for (std::size_t c = 0; c < d.c_deg.size(); ++c) {
    for (std::size_t g = 0; g < d.gamma_deg.size(); ++g) {
      d.at(c, g) = intensity(direction_from_type_c({radians(d.c_deg[c]), radians(d.gamma_deg[g])}));
    }
  }
  return d;
}

TEST(TargetRectangle, CutsAQuarterOfAPercentOffEachSideOfALambertianEmitter) {
  // The flux of a Lambertian emitter is uniform over the disc of direction cosines: the share below u is
  // (a - sin a cos a) / pi with cos a = -u.
  const auto r = target_rectangle(distribution([](const Direction& d) { return std::max(0.0, -d.z()); }));
  EXPECT_EQ(r.world_from_rectangle.ez(), (Vec3{0, 0, -1}));
  const auto below = [](double u) {
    const double a = std::acos(-u);
    return (a - std::sin(a) * std::cos(a)) / std::numbers::pi;
  };
  EXPECT_NEAR(below(r.u_min), 0.0025, 1e-4);
  EXPECT_NEAR(below(r.u_max), 0.9975, 1e-4);
  EXPECT_NEAR(below(r.v_min), 0.0025, 1e-4);
  EXPECT_NEAR(below(r.v_max), 0.9975, 1e-4);
  EXPECT_FALSE(r.is_plane);
}

TEST(TargetRectangle, TakesTheNearestAxisAndNeverATiltedOne) {
  const Vec3 axes[] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const Vec3& axis : axes) {
    const Direction tilted = Direction::from(axis + Vec3{0.3, 0.2, 0.25});
    const auto r = target_rectangle(distribution(
        [&](const Direction& d) { return std::exp(-std::pow(angle_between(d, tilted) / 0.1, 2)); }));
    const Frame& f = r.world_from_rectangle;
    EXPECT_EQ(f.ez(), axis);
    EXPECT_NEAR(length(cross(f.ex(), f.ey()) - f.ez()), 0.0, 1e-15);
    EXPECT_NEAR(0.5 * (r.u_min + r.u_max), dot(tilted, f.ex()), 0.01);
    EXPECT_NEAR(0.5 * (r.v_min + r.v_max), dot(tilted, f.ey()), 0.01);
  }
}

TEST(TargetRectangle, LightBehindDoesNotWidenIt) {
  const auto spot = [](const Direction& d) { return -d.z() > std::cos(0.2) ? 1.0 : 0.0; };
  const auto with = [&](const Direction& d) { return spot(d) + (d.z() > 0.5 ? 0.01 : 0.0); };
  const auto a = target_rectangle(distribution(spot)), b = target_rectangle(distribution(with));
  EXPECT_NEAR(a.width(), b.width(), 1e-3);
  EXPECT_LT(a.width(), 2.0 * std::sin(0.21));
}

TEST(TargetRectangle, OfAPlaneIsInMillimetres) {
  PlaneTarget plane;
  plane.size_x_mm = 2000.0;
  plane.size_y_mm = 1000.0;
  plane.map = {20, 10, std::vector<double>(200, 5.0)};
  const auto r = target_rectangle(plane);
  EXPECT_TRUE(r.is_plane);
  EXPECT_NEAR(r.u_min, -995.0, 0.1);
  EXPECT_NEAR(r.u_max, 995.0, 0.1);
  EXPECT_NEAR(r.v_max, 497.5, 0.1);
  DesignTarget target;
  target.plane = plane;
  EXPECT_EQ(target_rectangle(target), r);
}

TEST(TargetRectangle, RefusesDarkAndBrokenTargets) {
  EXPECT_THROW(target_rectangle(uniform_distribution(10.0, 5.0)), InputError);
  IntensityDistribution broken = distribution([](const Direction&) { return 1.0; });
  broken.cd.pop_back();
  EXPECT_THROW(target_rectangle(broken), InputError);
  PlaneTarget dark;
  dark.size_x_mm = dark.size_y_mm = 1.0;
  dark.map = {1, 1, {0.0}};
  EXPECT_THROW(target_rectangle(dark), InputError);
}

TEST(TargetRectangle, OfOneBrightNodeKeepsASize) {
  IntensityDistribution d = zero_distribution({0.0, 90.0, 180.0, 270.0}, {0.0, 1e-5, 180.0});
  for (std::size_t c = 0; c < 4; ++c) d.at(c, 0) = 1e6;
  const auto r = target_rectangle(d);
  EXPECT_GE(r.width(), 1e-4 * (1 - 1e-12));
  EXPECT_GE(r.height(), 1e-4 * (1 - 1e-12));
}

}  // namespace
}  // namespace lucerna
