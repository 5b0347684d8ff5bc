// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/ray_paths.h"

#include <gtest/gtest.h>

#include "lucerna/source/emitter.h"
#include "lucerna/trace/trace.h"

namespace lucerna {
namespace {

/// A point in the focus of a paraboloid that opens downward.
Scene collimator(double mirror_z_mm = 15.0) {
  Scene scene;
  PlacedSource source;
  source.rays = make_emitter({.kind = EmitterKind::point});
  scene.sources.push_back(source);
  const Reflector mirror = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0));
  const Frame placed = Frame::from_axis(Direction::from({0, 0, -1}), 0.0, {0, 0, mirror_z_mm});
  scene.reflectors.push_back({mirror, placed, Reflectance(1.0)});
  scene.far_fields.emplace_back();
  return scene;
}

TEST(RayPaths, LightOfTheFocusLeavesAlongTheAxis) {
  const auto paths = ray_paths(collimator(), 700);
  ASSERT_EQ(paths.size(), 700u);
  std::size_t reflected = 0;
  for (const RayPath& path : paths) {
    EXPECT_EQ(path.end, PathEnd::out);
    EXPECT_EQ(path.points_mm.front(), (Vec3{0, 0, 0}));
    if (path.points_mm.size() == 1) continue;
    ++reflected;
    ASSERT_EQ(path.points_mm.size(), 2u);
    const Vec3 p = path.points_mm[1];
    EXPECT_NEAR(p.z, 15.0 - (p.x * p.x + p.y * p.y) / 60.0, 1e-9);
    EXPECT_NEAR(path.last_direction.z(), -1.0, 1e-9);
  }
  EXPECT_GT(reflected, 300u);
}

TEST(RayPaths, BodiesStopOrReflect) {
  Scene scene = collimator();
  Body shield;
  shield.name = "shield";
  // A square below everything: all that leaves downwards meets it.
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices_mm = {{-500, -500, -40}, {500, -500, -40}, {500, 500, -40}, {-500, 500, -40}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  shield.mesh = mesh;
  scene.bodies.push_back(shield);
  for (const RayPath& path : ray_paths(scene, 300)) {
    if (path.end == PathEnd::body) {
      EXPECT_NEAR(path.points_mm.back().z, -40.0, 1e-3);
    } else {
      EXPECT_GT(path.last_direction.z(), -0.2);  // beside the square
    }
  }
  scene.bodies[0].reflectance = Reflectance(0.5);
  std::size_t up = 0;
  for (const RayPath& path : ray_paths(scene, 300)) {
    EXPECT_NE(path.end, PathEnd::body);
    if (path.points_mm.size() > 2) ++up;
  }
  EXPECT_GT(up, 100u);
}

TEST(RayPaths, AreTheRaysOfTheTrace) {
  // Shares of the same rays: with reflectance 1 the tracer's ledger counts them.
  const Scene scene = collimator(-20.0);
  TraceOptions options;
  options.seed = 7;
  options.first_ray = 1000;
  options.last_ray = 3000;
  const Ledger l = ledger(trace(scene, options));
  const auto paths = ray_paths(scene, 2000, {.seed = 7, .first_ray = 1000});
  std::size_t direct = 0, back = 0;
  for (const RayPath& path : paths) {
    if (path.end == PathEnd::mirror_back) ++back;
    if (path.end == PathEnd::out && path.points_mm.size() == 1) ++direct;
  }
  EXPECT_GT(back, 0u);
  EXPECT_NEAR(static_cast<double>(direct) / 2000.0, l.out_direct.mean / l.emitted, 1e-6);
  EXPECT_NEAR(static_cast<double>(back) / 2000.0, l.absorbed[1].second.mean / l.emitted, 1e-6);
}

}  // namespace
}  // namespace lucerna
