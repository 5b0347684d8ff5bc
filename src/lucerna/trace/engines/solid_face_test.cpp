// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "lucerna/trace/engines/solids_apart.h"
#include "tests/support/random_rays.h"
#include "tests/support/spline_face.h"
#include "tests/support/through_solid.h"

namespace lucerna {
namespace {

/// A sphere of radius 40 with its top at z = 5.
double cap(double x, double y) { return -35.0 + std::sqrt(1600.0 - x * x - y * y); }

Solid capped(std::shared_ptr<const HeightSurface> face) {
  Solid s;
  s.name = "lens";
  s.outline_mm = {{0, 0}, {10, 0}, {10, 2}};
  s.face = std::move(face);
  s.refractive_index = 1.5;
  return s;
}

Solid capped() { return capped(test::spline_face(cap, 11.0, 60)); }

/// The same lens as an outline, as exact as outlines are.
Solid turned_cap() {
  Solid s = capped();
  s.face = nullptr;
  s.outline_mm = {{0, 0}, {10, 0}};
  constexpr int kSteps = 200;
  for (int i = kSteps; i >= 0; --i) {
    const double r = 10.0 * i / kSteps;
    s.outline_mm.push_back({r, cap(r, 0.0)});
  }
  return s;
}

TEST(SolidFace, ASphereAsASplineSendsLightWhereItsOutlineDoes) {
  const SolidTracer spline({capped()}), outline({turned_cap()});
  const test::LightDistance light = test::light_distance(spline, outline, 9.0, 2000);
  EXPECT_GT(light.compared, 1700);
  EXPECT_LT(light.worst_mm, 1e-3);
}

// Against the same body as triangles, which are within 1e-5 of its size.
TEST(SolidFace, RaysMeetWhatItsTrianglesShow) {
  Solid meshed = capped();
  meshed.mesh = surface_mesh(capped(), 1e-5);
  meshed.outline_mm.clear();
  meshed.face = nullptr;
  const SolidTracer exact({capped()}), triangles({meshed});
  int met = 0, edges = 0;
  for (std::uint64_t i = 0; i < 5000; ++i) {
    Rng rng(5, i);
    const auto in_box = [&] {
      return Vec3{30.0 * rng.uniform() - 15.0, 30.0 * rng.uniform() - 15.0, 20.0 * rng.uniform() - 7.0};
    };
    const Vec3 from = in_box(), to = in_box();
    const Ray ray{from, Direction::from(to - from)};
    const auto a = exact.first_hit(ray, 1e9, false), b = triangles.first_hit(ray, 1e9, false);
    met += a && b ? 1 : 0;
    // Beside a rim the one is met and the other missed.
    const bool same = a.has_value() == b.has_value() && (!a || std::abs(a->t_mm - b->t_mm) < 0.01);
    edges += same ? 0 : 1;
  }
  EXPECT_GT(met, 1500);
  EXPECT_LE(edges, 5);
}

// From within, towards the circle where face and wall meet and to either side of it by less than rounding.
TEST(SolidFace, NoLightSlipsThroughItsEdges) {
  const SolidTracer tracer({capped()});
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Rng rng(7, i);
    const double phi = radians(360.0 * rng.uniform()), off = 1e-10 * (rng.uniform() - 0.5);
    const Vec3 rim{10.0 * std::cos(phi), 10.0 * std::sin(phi), cap(10.0, 0.0) + off};
    const Vec3 from{8.0 * rng.uniform() - 4.0, 8.0 * rng.uniform() - 4.0, 1.0 + rng.uniform()};
    const auto hit = tracer.first_hit({from, Direction::from(rim - from)}, 1e9, false);
    ASSERT_TRUE(hit) << i;
    EXPECT_NEAR(hit->t_mm, length(rim - from), 1e-6) << i;
  }
}

TEST(SolidFace, IsPlacedWithItsBody) {
  Solid moved = capped();
  moved.world_from_solid = Frame({0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {7, -3, 2});
  const SolidTracer here({capped()}), there({moved});
  const Ray ray{{3.0, 2.0, -1.0}, Direction::from({0.05, 0.02, 1.0})};
  const GlassPassage a = test::through_solid(here, ray, 1),
                     b = test::through_solid(there, moved.world_from_solid.ray(ray), 1);
  const Ray expected = moved.world_from_solid.ray(a.ray);
  EXPECT_LT(length(b.ray.origin_mm - expected.origin_mm), 1e-5);
  EXPECT_LT(length(b.ray.direction.vec() - expected.direction.vec()), 1e-6);
}

TEST(SolidFace, MeshesAreClosedAtAnyTolerance) {
  for (const double tolerance : {1e-2, kSurfaceTolerance, 1e-5})
    EXPECT_EQ(open_edges(*surface_mesh(capped(), tolerance)), 0U);
}

TEST(SolidFace, WhatDoesNotFitIsRefusedByName) {
  const auto expect = [](const Solid& solid, const std::string& part) {
    EXPECT_THAT(test::message_of<InputError>([&] { check(solid); }), testing::HasSubstr(part));
  };
  Solid deep = capped();
  deep.outline_mm = {{0, 6}, {5, 0}, {10, 0}, {10, 2}};
  expect(deep, "solid 'lens': face: found z = 5 at x = 0, y = 0, expected it above the outline below, z = 6");
  Solid high = capped();
  high.outline_mm = {{0, 0}, {12, 0}, {12, 4}, {10, 4}, {10, 5}};
  expect(high, "solid 'lens': face: found z = 3.72983 at its rim");
  Solid no_wall = capped();
  no_wall.outline_mm.pop_back();
  expect(no_wall, "solid 'lens': outline below a face: found 2 corners");
  Solid both = capped();
  both.mesh = surface_mesh(both);
  expect(both, "solid 'lens' has both");
  both.outline_mm.clear();
  expect(both, "solid 'lens' has a mesh and a face");
  EXPECT_THROW(static_cast<void>(surface_mesh(deep)), InputError);
}

TEST(SolidFace, TouchesWhatItTouches) {
  Scene scene;
  scene.solids = {capped(), capped()};
  scene.solids[1].name = "other";
  scene.solids[1].world_from_solid = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 5.1});
  check_apart(scene);
  scene.solids[1].world_from_solid = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 4.9});
  EXPECT_THAT(test::message_of<InputError>([&] { check_apart(scene); }), testing::HasSubstr("solid 'lens'"));
}

}  // namespace
}  // namespace lucerna
