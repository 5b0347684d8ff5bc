// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/search/support_tighten.h"

#include <gtest/gtest.h>

#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"

namespace lucerna {
namespace {

const Frame kPlaced = Frame::from_axis(Direction::from({1, 2, -3}), 0.7, {5, -7, 30});

RayBlock rays_of(EmitterKind kind) {
  EmitterOptions options;
  options.kind = kind;
  RayBlock local = draw_rays(*make_emitter(options), Sequence(SequenceKind::random, 3), 40'000);
  for (std::size_t i = 0; i < local.size(); ++i) local.set(i, kPlaced.ray(local.ray(i)));
  return local;
}

/// Share of the rays whose lines miss it.
double missed(const Support& support, const RayBlock& rays) {
  std::size_t n = 0;
  for (std::size_t i = 0; i < rays.size(); ++i) n += support.to_chart(rays.ray(i)) ? 0 : 1;
  return static_cast<double>(n) / static_cast<double>(rays.size());
}

/// Too long by 1.2 mm, too wide by a tenth and 0.4 mm off along the axis of the cylinder emitter (1 mm, 6
/// mm).
Support loose_cylinder() {
  Support s;
  s.kind = SupportKind::cylinder;
  s.radius_mm = 1.1;
  s.half_size_mm = {1.1, 1.1, 3.6};
  s.world_from_support = kPlaced * Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 0.4});
  return s;
}

TEST(SupportTighten, FindsTheEdgesOfACylinder) {
  const RayBlock rays = rays_of(EmitterKind::cylinder);
  const auto s = tightened(loose_cylinder(), rays, 0.0);
  ASSERT_TRUE(s);
  // Rays that only just touch an end are few: it is known to a few parts in ten thousand.
  EXPECT_NEAR(s->radius_mm, 1.0, 1e-4);
  EXPECT_NEAR(s->half_size_mm.z, 3.0, 5e-3);
  EXPECT_NEAR(length(s->world_from_support.origin_mm() - kPlaced.origin_mm()), 0.0, 5e-3);
  EXPECT_EQ(missed(*s, rays), 0.0);
}

TEST(SupportTighten, FindsTheRadiusOfASphere) {
  const RayBlock rays = rays_of(EmitterKind::sphere);
  Support s;
  s.kind = SupportKind::sphere;
  s.world_from_support = kPlaced;
  for (const double start_mm : {0.3, 4.0}) {
    s.radius_mm = start_mm;
    const auto t = tightened(s, rays, 0.0);
    ASSERT_TRUE(t);
    EXPECT_NEAR(t->radius_mm, 1.0, 1e-3);
    EXPECT_EQ(missed(*t, rays), 0.0);
  }
}

TEST(SupportTighten, LeavesOutTheShareOfStrayRays) {
  RayBlock rays = rays_of(EmitterKind::cylinder);
  const Frame aside = Frame::from_axis(Direction(), 0.3, {40, 0, 20});
  for (std::size_t i = 0; i < rays.size(); i += 1000) rays.set(i, aside.ray(rays.ray(i)));
  const auto loose = tightened(loose_cylinder(), rays, 0.0);
  const auto s = tightened(loose_cylinder(), rays, 2e-3);
  ASSERT_TRUE(loose && s);
  EXPECT_GT(loose->radius_mm, 2.0);
  EXPECT_NEAR(s->radius_mm, 1.0, 0.02);
  EXPECT_NEAR(s->half_size_mm.z, 3.0, 0.1);
  // The radius and either end may leave out as many.
  EXPECT_LE(missed(*s, rays), 3 * 2e-3);
}

TEST(SupportTighten, OnlyWhatHasEdges) {
  const RayBlock rays = rays_of(EmitterKind::cylinder);
  Support s;
  for (const SupportKind kind :
       {SupportKind::plane, SupportKind::disk, SupportKind::focal, SupportKind::axis}) {
    s.kind = kind;
    EXPECT_FALSE(tightened(s, rays, 0.0)) << to_string(kind);
  }
  EXPECT_FALSE(tightened(loose_cylinder(), RayBlock{}, 0.0));
}

}  // namespace
}  // namespace lucerna
