// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/cluster_octree.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

RayBlock cloud(std::size_t n) {
  RayBlock rays;
  rays.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(1, i);
    const double x = rng.uniform();
    rays.set(i, {{x * x * x, 2.0 * rng.uniform(), 0.5 * rng.uniform()}, Direction()});
    rays.weight[i] = i % 7 == 0 ? 0.0f : 1.0f;
  }
  return rays;
}

TEST(PositionOctree, HoldsEveryRayWithFluxOnceInSmallLeaves) {
  const RayBlock rays = cloud(20'000);
  const PositionOctree tree = build_position_octree(rays, 50, 1'000'000);
  std::vector<std::uint32_t> seen = tree.order;
  std::sort(seen.begin(), seen.end());
  EXPECT_EQ(std::unique(seen.begin(), seen.end()), seen.end());
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(std::count(rays.weight.begin(), rays.weight.end(), 1.0f)));
  for (std::size_t l = 0; l < tree.leaf_count(); ++l) {
    EXPECT_GT(tree.begin[l + 1], tree.begin[l]);
    EXPECT_LE(tree.begin[l + 1] - tree.begin[l], 50u);
    // A leaf is a cube: its rays span no more than the widest halving that it can be.
    for (std::uint32_t i = tree.begin[l]; i < tree.begin[l + 1]; ++i)
      EXPECT_GT(rays.weight[tree.order[i]], 0.0f);
  }
}

TEST(PositionOctree, RaysAtOnePlaceAreOneLeaf) {
  RayBlock rays = cloud(1000);
  for (std::size_t i = 0; i < rays.size(); ++i) rays.set(i, {{1, 2, 3}, Direction()});
  EXPECT_EQ(build_position_octree(rays, 10, 1'000'000).leaf_count(), 1u);
}

TEST(PositionOctree, SameForAnyNumberOfThreads) {
  const RayBlock rays = cloud(200'000);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return build_position_octree(rays, 100, 1'000'000);
  };
  const PositionOctree one = run(1), two = run(2);
  EXPECT_EQ(one.order, two.order);
  EXPECT_EQ(one.begin, two.begin);
}

TEST(PositionOctree, AMostNumberOfLeavesIsKeptAndUsed) {
  RayBlock rays;
  rays.resize(20'000);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    Rng rng(5, i);
    const double x = rng.uniform(), y = rng.uniform();
    rays.set(i, {{x * x, y, 0.0}, Direction()});
    rays.weight[i] = 1.0f;
  }
  for (const std::size_t max : {1u, 7u, 200u, 1000u}) {
    const PositionOctree tree = build_position_octree(rays, 1, max);
    EXPECT_LE(tree.leaf_count(), max);
    EXPECT_GE(tree.leaf_count() + 3, max / 2) << "room is used";
  }
}

TEST(PositionOctree, NoFluxIsAnError) {
  RayBlock rays = cloud(10);
  for (float& w : rays.weight) w = 0.0f;
  EXPECT_THROW(build_position_octree(rays, 10, 1'000'000), InputError);
}

}  // namespace
}  // namespace lucerna
