// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_meshes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/trace/kernels/triangle_bvh.h"
#include "tests/support/turned_outlines.h"

namespace lucerna {
namespace {

Body mesh_body(const test::OutlineCorners& outline, const Vec3& at_mm) {
  Solid solid;
  solid.outline_mm = outline;
  Body body;
  body.mesh = surface_mesh(solid, 1e-4);
  body.world_from_body = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, at_mm);
  return body;
}

/// A collimator, a ball and a ring beside each other.
std::vector<Body> mesh_bodies() {
  const auto shapes = test::turned_outlines();
  return {mesh_body(shapes[0], {0, 0, 0}), mesh_body(shapes[1], {30, 0, 0}),
          mesh_body(shapes[2], {0, 40, 0})};
}

TEST(SolidMeshes, FindTheTrianglesOfTheirOwnTree) {
  const std::vector<Body> bodies = mesh_bodies();
  const SolidMeshes meshes(bodies);
  const TriangleBvh tree(bodies, true);
  Rng rng(31, 0);
  int hits = 0, others = 0;
  for (int i = 0; i < 100000; ++i) {
    const Ray ray = test::ray_across(rng, 50.0);
    const double t_min = i % 3 == 0 ? 5.0 : 0.0, t_max = i % 5 == 0 ? 30.0 : 1e300;
    const SurfaceHit found = meshes.first(ray, t_min, t_max);
    const TriangleHit own = first_triangle(tree.view(), ray.origin_mm, ray.direction.vec(), t_min, t_max);
    if ((found.part < 0) != (own.triangle < 0)) {
      ++others;
      continue;
    }
    if (found.part < 0) continue;
    ++hits;
    const TreeTriangle& triangle = tree.triangles()[static_cast<std::size_t>(own.triangle)];
    if (std::abs(found.t_mm - own.t) > 1e-9 || meshes.body_of(found.part) != triangle.body) {
      ++others;
      continue;
    }
    const Vec3 at = ray.at(own.t), outward = meshes.outward(at, found), normal = normal_of(triangle);
    if (std::abs(dot(outward, normal)) < (1.0 - 1e-9) * length(outward) * length(normal))
      ++others;  // an edge
    EXPECT_NEAR(found.u, own.u, 0.05);
  }
  EXPECT_GT(hits, 4000);
  // At edges and silhouettes, where float and double see different triangles.
  EXPECT_LE(others, 2);
}

// Light that goes straight on enters and leaves in turn, from wherever it stands on the surface.
TEST(SolidMeshes, NothingSlipsThroughBetweenTriangles) {
  const SolidMeshes meshes(mesh_bodies());
  Rng rng(32, 0);
  int crossings = 0, lost = 0;
  for (int i = 0; i < 200000; ++i) {
    Ray ray = test::ray_across(rng, 40.0);
    if (i % 10 == 1) ray.direction = Direction::from({0, 0, 1});
    if (i % 10 == 2) ray.direction = Direction::from({ray.direction.x(), ray.direction.y(), 0.0});
    if (i % 10 == 3) ray.origin_mm = {0.0, 0.0, ray.origin_mm.z};
    ray.origin_mm = ray.at(-200.0);
    bool inside = false;
    for (int k = 0; k < 100; ++k) {
      const SurfaceHit hit = meshes.first(ray, kSolidStart, 1e300);
      if (hit.part < 0) break;
      ray.origin_mm = ray.at(hit.t_mm);
      const Vec3 outward = meshes.outward(ray.origin_mm, hit);
      const double along = dot(outward, ray.direction.vec()) / length(outward);
      if (std::abs(along) < 1e-3) continue;  // touches
      if ((along > 0.0) != inside) continue;
      inside = !inside;
      ++crossings;
    }
    lost += inside ? 1 : 0;
  }
  EXPECT_GT(crossings, 50000);
  EXPECT_EQ(lost, 0);
}

}  // namespace
}  // namespace lucerna
