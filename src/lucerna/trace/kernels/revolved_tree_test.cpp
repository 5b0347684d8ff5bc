// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/revolved_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/random.h"
#include "tests/support/turned_outlines.h"

namespace lucerna {
namespace {

using test::ray_across;
using test::turned_outlines;

SideHit side_hit(const RevolvedTree& tree, const Ray& ray, double t_min, double t_max = 1e300) {
  return first_side(tree.view(), ray.origin_mm, ray.direction.vec(), t_min, t_max);
}

TEST(RevolvedTree, HitsABallAtItsDistance) {
  const RevolvedTree tree(outline_sides(turned_outlines()[1], 20.0, 1e-7));
  Rng rng(1, 0);
  int hits = 0;
  for (int i = 0; i < 20000; ++i) {
    const Ray ray = ray_across(rng, 25.0);
    const double b = dot(ray.origin_mm, ray.direction.vec());
    const double spread = b * b - dot(ray.origin_mm, ray.origin_mm) + 100.0;
    if (std::abs(spread) < 0.5) continue;  // grazes: the ball's cones are up to a micrometre off
    const double root = spread > 0.0 ? std::sqrt(spread) : 0.0;
    const double t = spread < 0.0 ? -1.0 : -b - root > 0.0 ? -b - root : -b + root;
    const SideHit hit = side_hit(tree, ray, 0.0);
    ASSERT_EQ(hit.side >= 0, t > 0.0) << i;
    if (hit.side < 0) continue;
    ++hits;
    EXPECT_NEAR(hit.t, t, 1e-5) << i;
    const Vec3 at = ray.at(hit.t), normal = curve_normal(tree.view().sides[hit.side], hit.share, at);
    EXPECT_LT(length(normal - at / 10.0), 1e-5);
  }
  EXPECT_GT(hits, 1500);
}

TEST(RevolvedTree, FindsWhatAllSidesOneByOneHave) {
  Rng rng(2, 0);
  for (const test::OutlineCorners& shape : turned_outlines()) {
    const RevolvedTree tree(outline_sides(shape, 20.0, 1e-3));
    std::vector<RevolvedSide> sides;
    for (std::int32_t i = 0; i < tree.view().node_count; ++i) {
      if (tree.view().nodes[i].side >= 0) sides.push_back(tree.view().sides[tree.view().nodes[i].side]);
    }
    for (int i = 0; i < 5000; ++i) {
      const Ray ray = ray_across(rng, 20.0);
      SideHit best;
      best.t = 1e300;
      const RevolvedRay of(ray.origin_mm, ray.direction.vec());
      for (std::size_t k = 0; k < sides.size(); ++k)
        intersect_side(sides[k], static_cast<std::int32_t>(k), of, 0.0, best);
      const SideHit found = side_hit(tree, ray, 0.0);
      ASSERT_EQ(found.side >= 0, best.side >= 0) << i;
      if (found.side >= 0) {
        EXPECT_EQ(found.t, best.t) << i;
      }
    }
  }
}

// A ray from far away crosses a closed surface an even number of times, in and out alternately. Rays through
// the axis, along it and along flat sides are among them.
TEST(RevolvedTree, NothingSlipsThroughBetweenSides) {
  Rng rng(3, 0);
  int crossings = 0;
  for (const test::OutlineCorners& shape : turned_outlines()) {
    const RevolvedTree tree(outline_sides(shape, 20.0, 1e-5));
    for (int i = 0; i < 100000; ++i) {
      Ray ray = ray_across(rng, 16.0);
      if (i % 10 == 1) ray.direction = Direction::from({0, 0, 1});
      if (i % 10 == 2) ray.direction = Direction::from({ray.direction.x(), ray.direction.y(), 0.0});
      if (i % 10 == 3) ray.origin_mm = {0.0, 0.0, ray.origin_mm.z};
      ray.origin_mm = ray.at(-100.0);
      bool inside = false;
      double t = 0.0;
      for (int k = 0; k < 100; ++k) {
        const SideHit hit = side_hit(tree, ray, t + 1e-9);
        if (hit.side < 0) break;
        const double along =
            dot(cone_normal(tree.view().sides[hit.side], ray.at(hit.t)), ray.direction.vec());
        t = hit.t;
        if (std::abs(along) < 1e-5) continue;  // touches
        ASSERT_EQ(along > 0.0, inside) << i << " crossing " << k;
        inside = !inside;
        ++crossings;
      }
      ASSERT_FALSE(inside) << i;
    }
  }
  EXPECT_GT(crossings, 100000);
}

TEST(RevolvedTree, StartsBeyondTheNearEndAndStopsBeforeTheFarOne) {
  const RevolvedTree tree(outline_sides(test::OutlineCorners{{0, 0}, {5, 0}, {5, 2}, {0, 2}}, 0.0, 1e-3));
  const Ray up{{1.0, 1.0, -3.0}, Direction::from({0, 0, 1})};
  EXPECT_EQ(side_hit(tree, up, 0.0).t, 3.0);
  EXPECT_EQ(side_hit(tree, up, 3.0).t, 5.0);
  EXPECT_LT(side_hit(tree, up, 3.0, 5.0).side, 0);
  EXPECT_LT(side_hit(tree, up, 5.0).side, 0);
}

}  // namespace
}  // namespace lucerna
