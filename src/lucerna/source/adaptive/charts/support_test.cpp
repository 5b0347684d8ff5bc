// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/support.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/source/emitters/warp.h"
#include "tests/support/statistics.h"

namespace lucerna {
namespace {

constexpr double kPi = std::numbers::pi;

std::vector<Support> all_supports() {
  std::vector<Support> all;
  const Frame placed = Frame::from_axis(Direction::from({1, -2, 0.5}), 0.7, {0.3, -0.2, 0.4});
  for (std::size_t k = 0; k < kSupportKinds; ++k) {
    for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
      Support s;
      s.kind = static_cast<SupportKind>(k);
      s.map = map;
      s.world_from_support = placed;
      if (s.kind == SupportKind::sphere || s.kind == SupportKind::cylinder) s.radius_mm = 0.9;
      if (s.kind == SupportKind::cylinder) s.half_size_mm = {0.9, 0.9, 1.1};
      if (s.kind == SupportKind::box) s.half_size_mm = {0.5, 0.8, 1.1};
      if (s.kind == SupportKind::cylinder || s.kind == SupportKind::axis) s.twist_per_mm = 2.5;
      all.push_back(s);
      if (s.kind != SupportKind::plane && s.kind != SupportKind::sphere) continue;
      s.dome = {placed.point({0.1, 0.0, -0.1}), 2.8, 1.2};
      all.push_back(s);
    }
  }
  return all;
}

/// Lines through a ball of 3 mm about the support, uniform in étendue.
Ray uniform_line(const Support& s, Rng& rng) {
  const double u = rng.uniform(), v = rng.uniform(), a = rng.uniform(), b = rng.uniform();
  const Direction d = warp::sphere(u, v);
  const Vec3 p = 3.0 * warp::disk(a, b);
  return s.world_from_support.ray({Frame::from_z(d).vector(p), d});
}

double distance_to_line(const Vec3& p, const Ray& line) {
  return length(cross(p - line.origin_mm, line.direction.vec()));
}

TEST(Support, ALineComesBackFromItsNumbers) {
  for (const Support& s : all_supports()) {
    Rng rng(1, 2);
    int carried = 0;
    for (int i = 0; i < 2000; ++i) {
      const Ray ray = uniform_line(s, rng);
      const auto p = s.to_chart(ray);
      if (!p) continue;
      ++carried;
      ASSERT_LT(p->chart, s.charts());
      for (std::size_t d = 0; d < 4; ++d) {
        const auto range = s.range(p->chart, d);
        ASSERT_GE(p->c[d], range[0] - 1e-12) << to_string(s.kind) << " " << d;
        ASSERT_LE(p->c[d], range[1] + 1e-12) << to_string(s.kind) << " " << d;
      }
      const Ray back = s.from_chart(*p);
      ASSERT_LT(angle_between(back.direction, ray.direction), 1e-6) << to_string(s.kind);
      // Where the line all but grazes a plane, its crossing is far away and its angle matters more.
      const double far = 1.0 + length(back.origin_mm - ray.origin_mm);
      ASSERT_LT(distance_to_line(back.origin_mm, ray), 1e-7 * far) << to_string(s.kind);
    }
    EXPECT_GT(carried, 50) << to_string(s.kind);
  }
}

/// p-value for lines uniform in étendue being uniform in the numbers of chart `chart`, within the box.
double uniformity(const Support& s, std::uint32_t chart, const std::array<std::array<double, 2>, 4>& box,
                  double bend) {
  std::vector<double> counts(81, 0.0);
  Rng rng(7, chart);
  for (int i = 0; i < 400000; ++i) {
    const auto p = s.to_chart(uniform_line(s, rng));
    if (!p || p->chart != chart) continue;
    std::size_t cell = 0;
    bool in = true;
    for (std::size_t d = 0; d < 4; ++d) {
      double t = (p->c[d] - box[d][0]) / (box[d][1] - box[d][0]);
      in = in && t >= 0.0 && t < 1.0;
      if (d == 2) t = std::pow(std::max(0.0, t), bend);
      cell = cell * 3 + static_cast<std::size_t>(std::clamp(3.0 * t, 0.0, 2.0));
    }
    if (in) counts[cell] += 1.0;
  }
  return test::chi_square_uniform_p(counts);
}

std::array<std::array<double, 2>, 4> whole_box(const Support& s, std::uint32_t chart) {
  std::array<std::array<double, 2>, 4> box{};
  for (std::size_t d = 0; d < 4; ++d) {
    box[d] = s.range(chart, d);
    // Open coordinates: a part that lies well inside the ball for every direction.
    if (box[d][1] > 1e29) box[d] = {box[d][0] < -1e29 ? -1.5 : 0.0, 1.5};
  }
  return box;
}

TEST(SupportStatistical, VolumeOfTheNumbersIsEtendue) {
  for (const Support& s : all_supports()) {
    for (std::uint32_t chart = 0; chart < s.charts(); ++chart) {
      EXPECT_GT(uniformity(s, chart, whole_box(s, chart), 1.0), test::kFalseAlarm)
          << to_string(s.kind) << " map " << static_cast<int>(s.map) << " chart " << chart;
    }
  }
}

TEST(SupportStatistical, ABentCoordinateIsRejected) {
  for (const Support& s : all_supports()) {
    EXPECT_LT(uniformity(s, 0, whole_box(s, 0), 1.2), test::kFalseAlarm) << to_string(s.kind);
  }
}

TEST(Support, TheBoundingSurfaceIsASupport) {
  EXPECT_FALSE(support_on({}, PolarMap::polar).has_value());
  Rng rng(3, 3);
  for (const BoundingSurface& surface : {BoundingSurface::sphere(2.0), BoundingSurface::cylinder(1.0, 3.0),
                                         BoundingSurface::box({1, 2, 3}), BoundingSurface::plane(0.5)}) {
    const auto s = support_on(surface, PolarMap::concentric);
    ASSERT_TRUE(s.has_value());
    for (int i = 0; i < 500; ++i) {
      const Ray ray = uniform_line(*s, rng);
      const auto p = s->to_chart(ray);
      if (!p) continue;
      const Ray start = s->from_chart(*p);
      EXPECT_LT(std::abs(surface.outside_mm(start.origin_mm)), 1e-9);
      if (const auto t = surface.exit_distance_mm(ray)) {
        EXPECT_LT(length(start.origin_mm - ray.at(*t)), 1e-7 * (1.0 + length(start.origin_mm)));
      }
    }
  }
}

TEST(StartOn, EveryLineStartsOnTheSurface) {
  Rng rng(5, 5);
  const Support about;
  for (const BoundingSurface& surface : {BoundingSurface::sphere(0.8), BoundingSurface::cylinder(0.6, 1.0),
                                         BoundingSurface::box({1, 0.2, 0.7}), BoundingSurface::plane(0.5)}) {
    int moved = 0;
    for (int i = 0; i < 2000; ++i) {
      const Ray ray = uniform_line(about, rng), start = start_on(surface, ray);
      EXPECT_LT(std::abs(surface.outside_mm(start.origin_mm)), 1e-7 * (1.0 + length(start.origin_mm)));
      EXPECT_EQ(start.direction, ray.direction);
      const bool hit = surface.exit_distance_mm(ray).has_value();
      const double off = hit ? distance_to_line(start.origin_mm, ray) : 0.0;
      EXPECT_LT(off, 1e-7 * (1.0 + length(start.origin_mm)));
      moved += hit ? 0 : 1;
    }
    EXPECT_TRUE(moved > 100 || surface.kind == SurfaceKind::plane);
  }
  const Ray ray{{1, 2, 3}, Direction()};
  EXPECT_EQ(start_on({}, ray).origin_mm, ray.origin_mm);
}

// Found by fuzzing: the way along a plane overflowed.
TEST(StartOn, LinesAlongAPlaneAreDroppedOntoIt) {
  for (const double dz : {0.0, 5e-324, 1e-310, 1e-9, -1e-9, -1e-310}) {
    const Ray ray{{1, 2, 3}, Direction::from_unit({0, 1, dz})};
    const Ray start = start_on(BoundingSurface::plane(0.5), ray);
    EXPECT_EQ(start.origin_mm, (Vec3{1, 2, 0.5})) << dz;
    EXPECT_EQ(start.direction, ray.direction);
  }
}

TEST(Support, CoilsAreStraightWithTheirTwist) {
  Support s;
  s.kind = SupportKind::cylinder;
  s.radius_mm = 1.0;
  s.half_size_mm = {1, 1, 4};
  s.twist_per_mm = 1.5 * kPi;
  for (double z = -3.9; z < 3.9; z += 0.1) {
    const double azimuth = 0.3 + s.twist_per_mm * z;
    const Vec3 out{std::cos(azimuth), std::sin(azimuth), 0};
    const auto p = s.to_chart({out + Vec3{0, 0, z}, Direction::from(out)});
    ASSERT_TRUE(p.has_value());
    EXPECT_NEAR(p->c[0], 0.3, 1e-9);
  }
}

}  // namespace
}  // namespace lucerna
