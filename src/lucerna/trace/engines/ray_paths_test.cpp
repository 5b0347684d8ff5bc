// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/ray_paths.h"

#include <gtest/gtest.h>

#include "lucerna/source.h"
#include "lucerna/trace.h"

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
    EXPECT_EQ(path.end, RayEnd::out);
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
  // A square below everything: all that leaves downwards hits it.
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices_mm = {{-500, -500, -40}, {500, -500, -40}, {500, 500, -40}, {-500, 500, -40}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  shield.mesh = mesh;
  scene.bodies.push_back(shield);
  for (const RayPath& path : ray_paths(scene, 300)) {
    if (path.end == RayEnd::body) {
      EXPECT_NEAR(path.points_mm.back().z, -40.0, 1e-3);
    } else {
      EXPECT_GT(path.last_direction.z(), -0.2);  // beside the square
    }
  }
  scene.bodies[0].reflectance = Reflectance(0.5);
  std::size_t up = 0;
  for (const RayPath& path : ray_paths(scene, 300)) {
    EXPECT_NE(path.end, RayEnd::body);
    if (path.points_mm.size() > 2) ++up;
  }
  EXPECT_GT(up, 100u);
}

CoverGlass pane() {
  CoverGlass glass;
  glass.aperture = Aperture::circle(120.0);
  glass.thickness_mm = 4.0;
  glass.refractive_index = 1.5;
  glass.world_from_glass = Frame::from_axis(Direction::from({0, 0, 1}), 0.0, {0, 0, -40.0});
  return glass;
}

TEST(RayPaths, ObeySnelliusInsideAGlassAndGoOnInTheirDirection) {
  Scene scene = collimator();
  scene.glasses = {pane()};
  std::size_t through = 0, returned = 0, to_and_fro = 0;
  for (const RayPath& path : ray_paths(scene, 2000)) {
    ASSERT_EQ(path.reflections.size(), path.points_mm.size());
    EXPECT_EQ(path.reflections.front(), 0);
    for (std::size_t i = 1; i + 1 < path.points_mm.size(); ++i) {
      // A leg from face to face: its direction against that of the leg before the glass.
      const Vec3 in = path.points_mm[i], leg = path.points_mm[i + 1] - in;
      if (!(in.z < -35.9) || std::abs(std::abs(leg.z) - 4.0) > 1e-9) continue;
      if (path.points_mm[i - 1].z < -35.9) {
        ++to_and_fro;  // a reflection at a face: as steep as before
        const Vec3 before = in - path.points_mm[i - 1];
        EXPECT_NEAR(length(leg + before - 2.0 * Vec3{before.x, before.y, 0.0}), 0.0, 1e-9);
        continue;
      }
      const Vec3 before = in - path.points_mm[i - 1];
      const double outside = std::hypot(before.x, before.y) / length(before);
      EXPECT_NEAR(std::hypot(leg.x, leg.y) / length(leg), outside / 1.5, 1e-9);
      EXPECT_EQ(path.reflections[i], path.reflections[i - 1]);
    }
    for (std::size_t i = 1; i < path.points_mm.size(); ++i)
      returned += path.points_mm[i].z < -35.9 && path.reflections[i] > path.reflections[i - 1];
    const Vec3 last = path.points_mm.back();
    if (path.end != RayEnd::out || last.z > -35.9 || !(path.last_direction.z() < 0.0)) continue;
    ++through;
    EXPECT_NEAR(last.z, -40.0, 1e-9);
  }
  EXPECT_GT(through, 1000u);
  EXPECT_GT(returned, 80u);
  EXPECT_GT(to_and_fro, 20u);
}

TEST(RayPaths, EndAtTheRimOfAGlass) {
  Scene scene = collimator();
  scene.glasses = {pane()};
  scene.glasses[0].aperture = Aperture::circle(8.0);
  scene.glasses[0].thickness_mm = 30.0;
  std::size_t ended = 0;
  for (const RayPath& path : ray_paths(scene, 500)) {
    if (path.end != RayEnd::glass) continue;
    ++ended;
    const Vec3 p = path.points_mm.back();
    const bool on_rim = std::abs(std::hypot(p.x, p.y) - 4.0) < 1e-9;
    EXPECT_TRUE(on_rim || std::abs(p.z + 10.0) < 1e-9) << "at the rim, or into it from the face";
  }
  EXPECT_GT(ended, 3u);
}

TEST(RayPaths, AreTheRaysOfATraceThroughGlass) {
  Scene scene = collimator(-20.0);
  scene.glasses = {pane()};
  scene.glasses[0].world_from_glass = Frame::from_axis(Direction::from({0.3, 0, -1}), 0.0, {0, 0, -30});
  TraceOptions options;
  options.seed = 7;
  options.first_ray = 1000;
  options.last_ray = 5000;
  const Ledger l = ledger(trace(scene, options));
  const auto paths = ray_paths(scene, 4000, {.seed = 7, .first_ray = 1000});
  std::size_t direct = 0, reflected = 0, in_glass = 0, reflections = 0;
  for (const RayPath& path : paths) {
    if (path.end == RayEnd::out) ++(path.reflections.back() == 0 ? direct : reflected);
    in_glass += path.end == RayEnd::glass;
    reflections += static_cast<std::size_t>(path.reflections.back());
  }
  EXPECT_GT(reflected, 50u);
  EXPECT_GT(in_glass, 0u);
  EXPECT_NEAR(static_cast<double>(direct) / 4000.0, l.out_direct.mean / l.emitted, 1e-6);
  EXPECT_NEAR(static_cast<double>(reflected) / 4000.0, l.out_reflected.mean / l.emitted, 1e-6);
  EXPECT_NEAR(static_cast<double>(in_glass) / 4000.0, l.absorbed[2].second.mean / l.emitted, 1e-6);
  EXPECT_NEAR(static_cast<double>(reflections), 4000.0 * l.reflections_per_ray.mean, 1e-6);
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
    if (path.end == RayEnd::mirror_back) ++back;
    if (path.end == RayEnd::out && path.points_mm.size() == 1) ++direct;
  }
  EXPECT_GT(back, 0u);
  EXPECT_NEAR(static_cast<double>(direct) / 2000.0, l.out_direct.mean / l.emitted, 1e-6);
  EXPECT_NEAR(static_cast<double>(back) / 2000.0, l.absorbed[1].second.mean / l.emitted, 1e-6);
}

}  // namespace
}  // namespace lucerna
