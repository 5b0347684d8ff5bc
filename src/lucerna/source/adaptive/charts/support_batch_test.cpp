// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/support_batch.h"

#include <gtest/gtest.h>

#include <numbers>

#include "lucerna/random.h"

namespace lucerna {
namespace {

TEST(SupportBatch, AgreesWithOneRayAtATime) {
  const Frame placed = Frame::from_axis(Direction::from({1, -2, 0.5}), 0.7, {0.3, -0.2, 0.4});
  for (std::size_t k = 0; k < 2 * kSupportKinds; ++k) {
    for (const PolarMap map : {PolarMap::polar, PolarMap::concentric}) {
      Support s;
      s.kind = static_cast<SupportKind>(k % kSupportKinds);
      // Smaller than the support, so that some lines are moved to where they leave it.
      if (k >= kSupportKinds) s.dome = {{0.2, -0.3, 0.1}, 1.9, 1.5};
      s.map = map;
      s.world_from_support = placed;
      s.radius_mm = 1.3;
      s.half_size_mm = {0.5, 0.8, 1.1};
      s.twist_per_mm = s.kind == SupportKind::cylinder || s.kind == SupportKind::axis ? 7.0 : 0.0;
      for (std::uint32_t chart = 0; chart < s.charts(); ++chart) {
        std::array<BatchColumn, 4> c{};
        for (std::size_t i = 0; i < kSupportBatch; ++i) {
          Rng rng(k, i);
          for (std::size_t d = 0; d < 4; ++d) {
            auto range = s.range(chart, d);
            range = {std::max(range[0], -5.0), std::min(range[1], 5.0)};
            // Ends and the middle too: corners of the square, poles, the seam.
            const double t = i < 8 ? 0.5 * static_cast<double>((i >> d) % 3) : rng.uniform();
            c[d][i] = range[0] + t * (range[1] - range[0]);
          }
        }
        RayBatch batch;
        rays_from_chart(s, chart, c, batch);
        for (std::size_t i = 0; i < kSupportBatch; ++i) {
          const Ray one = s.from_chart({chart, {c[0][i], c[1][i], c[2][i], c[3][i]}});
          // Kepler's equation is solved to 1e-10 in batches; on a dome that moves starts too.
          const double tolerance = s.kind == SupportKind::axis ? 1e-9 : 1e-11;
          ASSERT_LT(length(batch.ray(i).origin_mm - one.origin_mm), tolerance)
              << to_string(s.kind) << " ray " << i;
          ASSERT_LT(length(batch.ray(i).direction.vec() - one.direction.vec()), 2e-8) << to_string(s.kind);
        }
      }
    }
  }
}

TEST(SupportBatch, StartsAgreeWithOneRayAtATime) {
  for (const BoundingSurface& surface :
       {BoundingSurface{}, BoundingSurface::sphere(0.8), BoundingSurface::cylinder(0.6, 1.0),
        BoundingSurface::box({1, 0.2, 0.7}), BoundingSurface::plane(0.5)}) {
    RayBatch batch;
    for (std::size_t i = 0; i < kSupportBatch; ++i) {
      Rng rng(3, i);
      const Vec3 p{2 * rng.uniform() - 1, 2 * rng.uniform() - 1, 2 * rng.uniform() - 1};
      batch.set(i, {p, Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5})});
    }
    RayBatch moved = batch;
    start_batch_on(surface, kSupportBatch, moved);
    for (std::size_t i = 0; i < kSupportBatch; ++i) {
      const Ray one = start_on(surface, batch.ray(i));
      ASSERT_LT(length(moved.ray(i).origin_mm - one.origin_mm), 1e-9) << to_string(surface.kind);
    }
  }
}

}  // namespace
}  // namespace lucerna
