// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "lucerna/trace/kernels/triangle_bvh.h"
#include "tests/support/turned_outlines.h"

namespace lucerna {
namespace {

/// A collimator, a ball and a ring.
std::vector<Mesh> turned_meshes() {
  std::vector<Mesh> out;
  for (const test::OutlineCorners& outline : test::turned_outlines()) {
    Solid solid;
    solid.outline_mm = outline;
    out.push_back(*surface_mesh(solid, 1e-4));
  }
  return out;
}

TEST(SolidMesh, FindsTheTrianglesOfATreeInDouble) {
  int hits = 0, others = 0;
  for (const Mesh& mesh : turned_meshes()) {
    const SolidMesh found_by(std::make_shared<const Mesh>(mesh), 20.0);
    Body body;
    body.mesh = std::make_shared<const Mesh>(mesh);
    const TriangleBvh tree({body}, true);
    Rng rng(31, 0);
    for (int i = 0; i < 50000; ++i) {
      const Ray ray = test::ray_across(rng, 20.0);
      const double t_min = i % 3 == 0 ? 5.0 : 0.0, t_max = i % 5 == 0 ? 30.0 : 1e300;
      const SurfaceHit found = found_by.first(ray, t_min, t_max);
      const TriangleHit own = first_triangle(tree.view(), ray.origin_mm, ray.direction.vec(), t_min, t_max);
      if ((found.part < 0) != (own.triangle < 0)) {
        ++others;
        continue;
      }
      if (found.part < 0) continue;
      ++hits;
      // Corners are rounded to float from different origins.
      const Vec3 normal = normal_of(tree.triangles()[static_cast<std::size_t>(own.triangle)]);
      const double cosine = std::abs(dot(normal, ray.direction.vec())) / length(normal);
      if (std::abs(found.t_mm - own.t) * cosine > 2e-6) ++others;
      const Vec3 outward = found_by.outward(ray.at(own.t), found);
      if (std::abs(dot(outward, normal)) < (1.0 - 1e-6) * length(outward) * length(normal)) ++others;
    }
  }
  EXPECT_GT(hits, 10000);
  // At edges and silhouettes.
  EXPECT_LE(others, 20);
}

// Light that goes straight on enters and leaves in turn, from wherever it stands on the surface.
TEST(SolidMesh, NothingSlipsThroughBetweenTriangles) {
  int crossings = 0, lost = 0;
  for (const Mesh& mesh : turned_meshes()) {
    const SolidMesh body(std::make_shared<const Mesh>(mesh), 20.0);
    Rng rng(32, 0);
    for (int i = 0; i < 100000; ++i) {
      Ray ray = test::ray_across(rng, 16.0);
      if (i % 10 == 1) ray.direction = Direction::from({0, 0, 1});
      if (i % 10 == 2) ray.direction = Direction::from({ray.direction.x(), ray.direction.y(), 0.0});
      if (i % 10 == 3) ray.origin_mm = {0.0, 0.0, ray.origin_mm.z};
      ray.origin_mm = ray.at(-200.0);
      bool inside = false;
      for (int k = 0; k < 100; ++k) {
        const SurfaceHit hit = body.first(ray, kSolidStart, 1e300);
        if (hit.part < 0) break;
        ray.origin_mm = ray.at(hit.t_mm);
        const Vec3 outward = body.outward(ray.origin_mm, hit);
        const double along = dot(outward, ray.direction.vec()) / length(outward);
        if (std::abs(along) < 1e-3) continue;  // touches
        if ((along > 0.0) != inside) continue;
        inside = !inside;
        ++crossings;
      }
      lost += inside ? 1 : 0;
    }
  }
  EXPECT_GT(crossings, 50000);
  EXPECT_LE(lost, 1);
}

// Light and body move together, farther than float has digits for.
TEST(SolidMesh, TakesLightFarFromTheOriginAsItDoesThere) {
  Solid near;
  near.mesh = std::make_shared<const Mesh>(turned_meshes()[1]);
  near.refractive_index = 1.5;
  near.absorption_per_mm = 0.01;
  for (const double away_mm : {1e4, 1e6}) {
    const Vec3 offset{away_mm, -2.0 * away_mm, 0.5 * away_mm};
    Solid far = near;
    far.world_from_solid = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, offset);
    const SolidTracer here({near}), there({far});
    int compared = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      Rng rng(33, i);
      const Ray ray = test::ray_across(rng, 15.0);
      const auto a = here.first_hit(ray, 1e30, false);
      const auto b = there.first_hit({ray.origin_mm + offset, ray.direction}, 1e30, false);
      ASSERT_EQ(a.has_value(), b.has_value()) << i;
      if (!a) continue;
      EXPECT_NEAR(a->t_mm, b->t_mm, 1e-4) << i;
      const GlassPassage p = here.pass(ray, *a, {1, i, 0}, 0.0F);
      const GlassPassage q = there.pass({ray.origin_mm + offset, ray.direction}, *b, {1, i, 0}, 0.0F);
      if (p.transmitted != q.transmitted) continue;  // chance between reflection and refraction is that near
      ++compared;
      EXPECT_NEAR(p.throughput, q.throughput, 1e-3) << i;
    }
    EXPECT_GT(compared, 500);
  }
}

}  // namespace
}  // namespace lucerna
