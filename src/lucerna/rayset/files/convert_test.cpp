// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/files/convert.h"

#include <gtest/gtest.h>

#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/ray_file.h"
#include "tests/support/temp_dir.h"

namespace lucerna {
namespace {

RaySet random_set(std::size_t n) {
  RaySet set;
  set.header.flux_lm = 12.0;
  set.rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(8, i);
    set.rays.set(i,
                 {{rng.uniform(), rng.uniform(), rng.uniform()}, Direction::from({rng.uniform(), 1.0, 0.5})});
    set.rays.weight[i] = static_cast<float>(rng.uniform());
  }
  return set;
}

double sum(const RaySet& set) { return std::accumulate(set.rays.weight.begin(), set.rays.weight.end(), 0.0); }

TEST(ConvertRayFile, WithoutChangesTheRaysAreTheSameBits) {
  const test::TempDir dir;
  const RaySet set = random_set(kStreamBlock + 77);
  write_ray_set(dir / "a.tm25ray", set, "tm25");
  const auto result = convert_ray_file(dir / "a.tm25ray", dir / "b.tm25ray", "tm25", {});
  EXPECT_EQ(result.rays, set.rays.size());
  EXPECT_EQ(read_ray_set(dir / "b.tm25ray"), read_ray_set(dir / "a.tm25ray"));
}

TEST(ConvertRayFile, ASubsetKeepsTheFlux) {
  const test::TempDir dir;
  const RaySet set = random_set(20'000);
  write_ray_set(dir / "a.tm25ray", set, "tm25");
  convert_ray_file(dir / "a.tm25ray", dir / "b.tm25ray", "tm25", {.rays = 777, .seed = 3});
  const RaySet fewer = read_ray_set(dir / "b.tm25ray");
  EXPECT_EQ(fewer.rays.size(), 777u);
  EXPECT_EQ(fewer.header.flux(), set.header.flux());
  EXPECT_NEAR(sum(fewer), sum(set), 1e-5 * sum(set));
  EXPECT_THROW(convert_ray_file(dir / "a.tm25ray", dir / "c.tm25ray", "tm25", {.rays = 20'001}), InputError);
  EXPECT_FALSE(std::filesystem::exists(dir / "c.tm25ray"));
}

TEST(ConvertRayFile, MovingThereAndBackReturnsTheRays) {
  const test::TempDir dir;
  const RaySet set = random_set(500);
  write_ray_set(dir / "a.tm25ray", set, "tm25");
  const Frame motion = Frame::from_axis(Direction::from({1, 2, 3}), 0.4, {5, 6, 7});
  convert_ray_file(dir / "a.tm25ray", dir / "b.tm25ray", "tm25", {.new_from_old = motion});
  convert_ray_file(dir / "b.tm25ray", dir / "c.tm25ray", "tm25",
                   {.flux = 99.0, .new_from_old = motion.inverse()});
  const RaySet there = read_ray_set(dir / "b.tm25ray"), back = read_ray_set(dir / "c.tm25ray");
  EXPECT_EQ(back.header.flux(), 99.0);
  for (std::size_t i = 0; i < 500; ++i) {
    EXPECT_LT(length(there.rays.origin_mm(i) - motion.point(set.rays.origin_mm(i))), 2e-6);
    EXPECT_LT(length(back.rays.origin_mm(i) - set.rays.origin_mm(i)), 4e-6);
    EXPECT_LT(length(back.rays.direction(i).vec() - set.rays.direction(i).vec()), 4e-7);
  }
}

}  // namespace
}  // namespace lucerna
