// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/chart_batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/random.h"
#include "lucerna/source/adaptive/charts/batch_math.h"

namespace lucerna {
namespace {

Support support_of(SupportKind kind, PolarMap map, bool dome) {
  Support s;
  s.kind = kind;
  s.map = map;
  s.world_from_support = Frame::from_axis(Direction::from({1, -2, 0.5}), 0.7, {0.3, -0.2, 0.4});
  if (dome) s.dome = {{0.2, -0.3, 0.1}, 1.9, 1.5};
  s.radius_mm = 1.3;
  s.half_size_mm = {0.5, 0.8, 1.1};
  s.twist_per_mm = kind == SupportKind::cylinder || kind == SupportKind::axis ? 7.0 : 0.0;
  return s;
}

/// Rays of all directions about the support; some run exactly along its axes, or through its middle.
RayBlock lines(const Support& s, std::size_t n) {
  RayBlock rays;
  rays.resize(n, 0);
  const Frame& f = s.world_from_support;
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(5, i);
    Vec3 o{4 * rng.uniform() - 2, 4 * rng.uniform() - 2, 4 * rng.uniform() - 2};
    Vec3 d{rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5};
    if (i % 16 == 0) d = i % 32 == 0 ? f.ez() : f.ex();
    if (i % 16 == 1) o = f.origin_mm();
    rays.set(i, {o, Direction::from(d)});
  }
  return rays;
}

TEST(ChartBatch, AgreesWithOneLineAtATime) {
  constexpr std::size_t kRays = 20 * kSupportBatch;
  for (std::size_t k = 0; k < 2 * kSupportKinds; ++k) {
    for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
      const Support s = support_of(static_cast<SupportKind>(k % kSupportKinds), map, k >= kSupportKinds);
      const RayBlock rays = lines(s, kRays);
      std::size_t carried = 0, apart = 0;
      for (std::size_t first = 0; first < kRays; first += kSupportBatch) {
        RayBatch batch;
        ChartBatch found;
        load_batch(rays, first, 1, kSupportBatch, batch);
        charts_of(s, batch, found);
        for (std::size_t i = 0; i < kSupportBatch; ++i) {
          const auto one = s.to_chart(rays.ray(first + i));
          const std::uint32_t chart = one ? one->chart : kNoChart;
          // Lines to within rounding of an edge may be on either side of it.
          if (found.chart[i] != chart) ++apart;
          if (!one || found.chart[i] != chart) continue;
          ++carried;
          // The same line: near a seam or pole its numbers may differ.
          const Ray a = s.from_chart(*one), b = s.from_chart({chart, found.point(i)});
          const double far = 1.0 + length(a.origin_mm);
          ASSERT_LT(length(a.origin_mm - b.origin_mm), 1e-8 * far * far)
              << to_string(s.kind) << " " << first + i;
          ASSERT_LT(length(a.direction.vec() - b.direction.vec()), 1e-7)
              << to_string(s.kind) << " " << first + i;
        }
      }
      EXPECT_GT(carried, kRays / 20) << to_string(s.kind);
      EXPECT_LE(apart, 4u) << to_string(s.kind);
    }
  }
}

TEST(ChartBatch, TheLastBatchRepeatsItsLastRay) {
  const RayBlock rays = lines(support_of(SupportKind::focal, PolarMap::polar, false), 40);
  RayBatch batch;
  load_batch(rays, 1, 3, 7, batch);
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const Ray ray = rays.ray(1 + 3 * std::min<std::size_t>(i, 6));
    EXPECT_EQ(batch.ray(i).origin_mm, ray.origin_mm);
    EXPECT_LT(length(batch.ray(i).direction.vec() - ray.direction.vec()), 1e-15);
  }
}

TEST(BatchMath, AzimuthsAreThoseOfTheLibrary) {
  for (int i = 0; i < 200000; ++i) {
    Rng rng(6, static_cast<std::uint64_t>(i));
    const double scale = std::exp(20.0 * rng.uniform() - 10.0);
    const double x = scale * (rng.uniform() - 0.5),
                 y = (rng.uniform() - 0.5) * std::exp(8.0 * rng.uniform() - 4.0);
    ASSERT_NEAR(batch::azimuth(y, x), std::atan2(y, x), 1e-15);
  }
  EXPECT_EQ(batch::azimuth(0.0, 0.0), 0.0);
  EXPECT_EQ(batch::azimuth(0.0, -1.0), std::numbers::pi);
  EXPECT_EQ(batch::azimuth(1.0, 0.0), 0.5 * std::numbers::pi);
  EXPECT_EQ(batch::azimuth(-1.0, -1.0), -0.75 * std::numbers::pi);
}

TEST(BatchMath, LogarithmsAreThoseOfTheLibrary) {
  for (int i = 0; i < 200000; ++i) {
    Rng rng(7, static_cast<std::uint64_t>(i));
    const double x = std::exp((i % 2 == 0 ? 2.0 : 1200.0) * (rng.uniform() - 0.5));
    ASSERT_NEAR(batch::logarithm(x), std::log(x), 4e-15 * (1.0 + std::abs(std::log(x)))) << x;
  }
  EXPECT_EQ(batch::logarithm(1.0), 0.0);
}

}  // namespace
}  // namespace lucerna
