// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/design_rays.h"

#include <gtest/gtest.h>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source.h"
#include "tests/support/one_at_a_time.h"

namespace lucerna {
namespace {

TEST(DesignRays, TellProgressOneAtATime) {
  DesignRays rays({{make_emitter({.kind = EmitterKind::disk}), Frame(), {}}}, Frame(), 1);
  test::OneAtATime watch;
  const ThreadLimit limit(4);
  rays.grow(std::uint64_t{1} << 18, watch);
  EXPECT_GE(watch.calls, 16);
  EXPECT_EQ(watch.overlaps, 0);
  EXPECT_EQ(watch.falls, 0);
}

// Half of the light of the rays that go to one side, none of the others.
TEST(DesignRays, SayHowMuchLightIsLeft) {
  DesignRays rays({{make_emitter({}), Frame(), {}}}, Frame(), 1);
  rays.refract({1.5, 0.0}, [](Ray& ray) { return ray.direction.x() > 0.0 ? 0.5 : 0.0; });
  const std::uint64_t count = kBlockRays * kDesignTasks;
  rays.grow(count);
  EXPECT_NEAR(rays.share_left(count), 0.25, 1e-3);
  EXPECT_NEAR(rays.share_left(kBlockRays), 0.25, 0.02);
}

}  // namespace
}  // namespace lucerna
