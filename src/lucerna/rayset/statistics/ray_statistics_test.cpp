// SPDX-License-Identifier: Apache-2.0
#include "lucerna/ray_statistics.h"

#include <gtest/gtest.h>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/geometry.h"
#include "lucerna/ray_file.h"
#include "tests/support/data_dir.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

TEST(RayStatistics, AllRaysThroughOnePointMeetThere) {
  RayBlock rays = test::random_ray_set(1000, 1).rays;
  const Vec3 focus{1.0, -2.0, 300.0};
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Ray ray = rays.ray(i);
    rays.set(i, {focus + (0.01 * static_cast<double>(i)) * ray.direction.vec(), ray.direction});
  }
  const RaySummary s = summarize(rays);
  ASSERT_TRUE(s.virtual_focus && s.virtual_focus->determined);
  EXPECT_LT(length(s.virtual_focus->point_mm - focus), 1e-5);
}

TEST(RayStatistics, FocusIsTheMinimumOfTheWeightedSquaredDistances) {
  const RayBlock rays = test::random_ray_set(500, 2).rays;
  const auto cost = [&](const Vec3& p) {
    double sum = 0.0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const Vec3 across = cross(p - rays.origin_mm(i), rays.direction(i));
      sum += static_cast<double>(rays.weight[i]) * dot(across, across);
    }
    return sum;
  };
  const Vec3 f = summarize(rays).virtual_focus.value().point_mm;
  for (const Vec3& step : {Vec3{1e-3, 0, 0}, Vec3{0, 1e-3, 0}, Vec3{0, 0, 1e-3}}) {
    EXPECT_GT(cost(f + step), cost(f));
    EXPECT_GT(cost(f - step), cost(f));
  }
}

TEST(RayStatistics, CollimatedRaysHaveNoFocusAlongTheBeam) {
  RayBlock rays = test::random_ray_set(100, 3).rays;
  const Direction beam = Direction::from({1.0, 2.0, 2.0});
  for (std::size_t i = 0; i < rays.size(); ++i) rays.set(i, {rays.origin_mm(i), beam});
  const RaySummary s = summarize(rays);
  ASSERT_TRUE(s.virtual_focus);
  EXPECT_FALSE(s.virtual_focus->determined);
  EXPECT_LT(length(s.virtual_focus->point_mm - *s.mean_start_mm), 1e-5);
  EXPECT_NEAR(length(*s.mean_direction), 1.0, 1e-6);
}

TEST(RayStatistics, SumsAndShares) {
  RayBlock rays;
  rays.resize(3, 0);
  rays.set(0, {{1, 2, 3}, Direction::from({0, 0, 1})});
  rays.set(1, {{-1, 5, 3}, Direction::from({0, 0, -1})});
  rays.set(2, {{0, 0, -7}, Direction::from({1, 0, 0})});
  rays.weight = {1.0F, 2.0F, 5.0F};
  const RaySummary s = summarize(rays);
  EXPECT_EQ(s.count, 3u);
  EXPECT_EQ(s.weight_sum, 8.0);
  EXPECT_EQ(*s.backwards_share, 0.25);
  EXPECT_EQ(*s.extent_min_mm, (Vec3{-1, 0, -7}));
  EXPECT_EQ(*s.extent_max_mm, (Vec3{1, 5, 3}));
  EXPECT_FALSE(s.equal_weights);
  EXPECT_NEAR(s.effective_rays, 64.0 / 30.0, 1e-12);
  EXPECT_EQ(*s.mean_start_mm, (Vec3{-0.125, 1.5, -3.25}));
  EXPECT_EQ(*s.mean_direction, (Vec3{0.625, 0.0, -0.125}));
}

TEST(RayStatistics, NoRaysAndNoFluxAreAccepted) {
  EXPECT_EQ(summarize(RayBlock{}).count, 0u);
  EXPECT_FALSE(summarize(RayBlock{}).extent_min_mm);
  RayBlock dark = test::random_ray_set(5, 1).rays;
  dark.weight.assign(5, 0.0F);
  const RaySummary s = summarize(dark);
  EXPECT_TRUE(s.extent_min_mm && s.equal_weights);
  EXPECT_FALSE(s.virtual_focus || s.backwards_share || s.mean_direction);
}

TEST(RayStatistics, SameBitsForAnyNumberOfThreads) {
  const RayBlock rays = test::random_ray_set(100000, 4).rays;
  const Vec3 many = summarize(rays).virtual_focus->point_mm;
  const ThreadLimit one(1);
  EXPECT_EQ(summarize(rays).virtual_focus->point_mm, many);
}

TEST(RayStatisticsData, MeasuredLed) {
  LUCERNA_DATA_FILE(path, "rayfiles/rayfile_LERTDUW_S2WP_green_100k_20161013_IES_TM25.TM25RAY");
  const RaySummary s = summarize(read_ray_set(path).rays);
  EXPECT_NEAR(s.weight_sum, 337.0, 0.01);
  EXPECT_TRUE(s.equal_weights);
  const Vec3 f = s.virtual_focus->point_mm;
  EXPECT_NEAR(f.x, -0.6836, 1e-4);
  EXPECT_NEAR(f.y, 0.8361, 1e-4);
  EXPECT_NEAR(f.z, -0.4491, 1e-4);
  EXPECT_NEAR(*s.backwards_share, 0.00056, 0.000005);
  EXPECT_NEAR(s.extent_min_mm->z, -1.18, 0.01);
  EXPECT_NEAR(s.extent_max_mm->z, 0.02, 1e-6);
}

}  // namespace
}  // namespace lucerna
