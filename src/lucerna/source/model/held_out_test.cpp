// SPDX-License-Identifier: Apache-2.0
#include "lucerna/held_out.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/error.h"
#include "lucerna/ray_file.h"
#include "lucerna/source.h"
#include "lucerna/source/emitters/draw_rays.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

RaySet lamp_rays(EmitterKind kind, std::size_t n, std::uint64_t seed = 1) {
  const auto emitter = make_emitter({.kind = kind});
  RaySet set;
  set.rays = draw_rays(*emitter, Sequence(SequenceKind::random, seed), n);
  set.header.set_flux(100.0);
  return set;
}

double largest_over_raw(const HeldOutComparison& found) {
  double most = 0.0;
  for (const ViewKind kind : kViewKinds)
    most = std::max(most, found.views[kind].excess / found.views[kind].raw);
  return most;
}

TEST(HeldOut, AModelOfALampIsNearerToItThanRaysAre) {
  const auto found = compare_held_out(lamp_rays(EmitterKind::led, 100'000));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->training_rays + found->held_out_rays, 100'000u);
  EXPECT_NEAR(static_cast<double>(found->held_out_rays), 50'000.0, 5.0 * 158.0);
  EXPECT_LT(largest_over_raw(*found), 1.0);
  for (const ScaleDifference& s : found->scales)
    EXPECT_LT(s.difference.excess, s.difference.raw) << s.cell_mm;
  for (std::size_t k = 1; k < found->scales.size(); ++k)
    EXPECT_DOUBLE_EQ(found->scales[k].cell_mm, 2.0 * found->scales[k - 1].cell_mm);
}

TEST(HeldOut, ABadModelIsSeen) {
  const RaySet rays = lamp_rays(EmitterKind::filament, 50'000);
  const auto small = compare_held_out(rays, {.method = CompressMethod::clusters, .max_bytes = 4000});
  ASSERT_TRUE(small);
  EXPECT_GT(largest_over_raw(*small), 10.0);
  for (const ScaleDifference& s : small->scales) EXPECT_GT(s.difference.excess, 5.0 * s.difference.raw);
}

/// Every other ray is of another lamp: halves that took turns would be of one lamp each.
TEST(HeldOut, HalvesFollowNoPatternOfTheFile) {
  const RaySet one = lamp_rays(EmitterKind::disk, 50'000), other = lamp_rays(EmitterKind::cylinder, 50'000);
  RaySet both;
  both.header = one.header;
  for (std::size_t i = 0; i < one.rays.size(); ++i) {
    both.rays.append(one.rays, i);
    both.rays.append(other.rays, i);
  }
  const auto found = compare_held_out(both);
  ASSERT_TRUE(found);
  EXPECT_LT(largest_over_raw(*found), 2.0);
  RayBlock even, odd;
  for (std::size_t i = 0; i < both.rays.size(); ++i) (i % 2 == 0 ? even : odd).append(both.rays, i);
  const RaySetComparison in_turns = compare_ray_sets(even, odd);
  EXPECT_GT(in_turns.near.excess / in_turns.near.raw,
            10.0);  // what the test would miss is there to be missed
}

TEST(HeldOut, IsTheSameForAnyNumberOfThreads) {
  const RaySet rays = lamp_rays(EmitterKind::disk, 20'000);
  const auto a = compare_held_out(rays, {.seed = 3});
  const ThreadLimit one(1);
  const auto b = compare_held_out(rays, {.seed = 3});
  ASSERT_TRUE(a && b);
  EXPECT_EQ(a->held_out_rays, b->held_out_rays);
  for (const ViewKind kind : kViewKinds) EXPECT_EQ(a->views[kind].error, b->views[kind].error);
}

TEST(HeldOut, FewRaysSayNothing) {
  EXPECT_FALSE(compare_held_out(lamp_rays(EmitterKind::disk, 150)));
  RaySet dark = lamp_rays(EmitterKind::disk, 1000);
  std::ranges::fill(dark.rays.weight, 0.0f);
  EXPECT_FALSE(compare_held_out(dark));
}

TEST(HeldOut, OfLargeFilesAsManyRaysAsAskedFor) {
  const test::TempDir dir;
  write_ray_set(dir / "a", lamp_rays(EmitterKind::disk, 30'000, 1), "tm25");
  write_ray_set(dir / "b", lamp_rays(EmitterKind::disk, 10'000, 2), "tm25");
  const auto all = compare_held_out({dir / "a"}, 30'000);
  const auto same = compare_held_out(read_ray_set(dir / "a"));
  ASSERT_TRUE(all && same);
  EXPECT_EQ(all->views.near.error, same->views.near.error);
  const auto some = compare_held_out({dir / "a", dir / "b"}, 20'000);
  ASSERT_TRUE(some);
  EXPECT_EQ(some->training_rays + some->held_out_rays, 20'000u);
  EXPECT_THROW(static_cast<void>(compare_held_out(std::vector<std::filesystem::path>{}, 1000)), UsageError);
}

}  // namespace
}  // namespace lucerna
