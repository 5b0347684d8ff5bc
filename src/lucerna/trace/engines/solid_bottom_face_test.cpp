// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "tests/support/random_rays.h"
#include "tests/support/spline_face.h"
#include "tests/support/through_solid.h"

namespace lucerna {
namespace {

using testing::HasSubstr;

/// Spheres: the top of radius 40, the bottom's hollow of radius 20, 2 deep on the axis.
double top_mm(double x, double y) { return -35.0 + std::sqrt(1600.0 - x * x - y * y); }
double bottom_mm(double x, double y) { return -18.0 + std::sqrt(400.0 - x * x - y * y); }

/// A lens over a hollow of radius 6, both faces splines.
Solid two_faces() {
  Solid s;
  s.name = "lens";
  s.outline_mm = {{6, 1}, {6, 0}, {10, 0}, {10, 2}};
  s.face = test::spline_face(top_mm, 11.0, 60);
  s.bottom_face = test::spline_face(bottom_mm, 7.0, 60);
  s.refractive_index = 1.5;
  return s;
}

/// The same as an outline, as exact as outlines are.
Solid turned() {
  Solid s = two_faces();
  s.face = s.bottom_face = nullptr;
  s.outline_mm.clear();
  constexpr int kSteps = 200;
  for (int i = 0; i <= kSteps; ++i)
    s.outline_mm.push_back({6.0 * i / kSteps, bottom_mm(6.0 * i / kSteps, 0.0)});
  s.outline_mm.insert(s.outline_mm.end(), {{6, 0}, {10, 0}});
  for (int i = kSteps; i >= 0; --i)
    s.outline_mm.push_back({10.0 * i / kSteps, top_mm(10.0 * i / kSteps, 0.0)});
  return s;
}

// Over hollow, inner wall and flange alike.
TEST(SolidBottomFace, SpheresAsSplinesSendLightWhereTheirOutlineDoes) {
  const SolidTracer spline({two_faces()}), outline({turned()});
  const test::LightDistance light = test::light_distance(spline, outline, 9.0, 4000);
  EXPECT_GT(light.compared, 3000);
  EXPECT_LT(light.worst_mm, 2e-3);
}

// From above and below, towards the circle where the bottom's rim and the wall about it meet.
TEST(SolidBottomFace, NoLightSlipsThroughItsEdges) {
  const SolidTracer tracer({two_faces()});
  for (std::uint64_t i = 0; i < 20000; ++i) {
    Rng rng(7, i);
    const double phi = radians(360.0 * rng.uniform()), off = 1e-10 * (rng.uniform() - 0.5);
    const Vec3 rim{6.0 * std::cos(phi), 6.0 * std::sin(phi), bottom_mm(6.0, 0.0) + off};
    const Vec3 from{4.0 * rng.uniform() - 2.0, 4.0 * rng.uniform() - 2.0,
                    i % 2 == 0 ? 4.0 + 0.4 * rng.uniform() : -1.0 - rng.uniform()};
    const auto hit = tracer.first_hit({from, Direction::from(rim - from)}, 1e9, false);
    ASSERT_TRUE(hit) << i;
    EXPECT_NEAR(hit->t_mm, length(rim - from), 1e-5) << i;
  }
}

TEST(SolidBottomFace, WhatDoesNotFitIsRefusedByName) {
  const auto expect = [](const Solid& solid, const std::string& part) {
    EXPECT_THAT(test::message_of<InputError>([&] { check(solid); }), HasSubstr(part));
  };
  check(two_faces());
  Solid alone = turned();
  alone.bottom_face = two_faces().bottom_face;
  expect(alone, "solid 'lens' has a bottom face alone");
  Solid on_axis = two_faces();
  on_axis.outline_mm.front() = {0, 1};
  expect(on_axis, "outline about a bottom face: found its first side from [0, 1] to [6, 0], expected a wall");
  Solid upward = two_faces();
  upward.outline_mm.front() = {6, -1};
  expect(upward, "from [6, -1] to [6, 0], expected a wall");
  Solid open = two_faces();
  open.bottom_face = nullptr;
  expect(open, "first corner at [6, 1], expected it on the axis");
  Solid low = two_faces();
  low.bottom_face = test::spline_face([](double x, double y) { return bottom_mm(x, y) - 1.5; }, 7.0, 60);
  expect(low, "bottom_face: found z = -0.421216 at its rim");
  Solid thin = two_faces();
  thin.bottom_face = test::spline_face([](double x, double y) { return bottom_mm(x, y) + 4.0; }, 7.0, 60);
  expect(thin, "face: found z = 5 at x = 0, y = 0, expected it above the outline below, z = 6");
  Solid smooth = two_faces();
  smooth.smooth_below_deg = 100.0;
  expect(smooth, "found a turn of 90 degrees into the wall");
}

// The outline's sides, then the top, then the bottom.
TEST(SolidBottomFace, ScattersByItsOwnNumber) {
  Solid rough = two_faces();
  rough.scatter = Scatter({gaussian_lobe(1.0, 0.3)});
  rough.scatter_sides = {rough.outline_mm.size()};
  const Ray up_hollow{{1, 1, -1}, Direction::from({0, 0, 1})},
      up_flange{{8, 0, -1}, Direction::from({0, 0, 1})};
  const SolidTracer plain({two_faces()}), tracer({rough});
  const auto same = [&](const Ray& ray) {
    int alike = 0;
    for (std::uint64_t i = 0; i < 50; ++i) {
      const GlassPassage a = test::through_solid(plain, ray, i), b = test::through_solid(tracer, ray, i);
      alike += length(a.ray.direction.vec() - b.ray.direction.vec()) < 1e-9 ? 1 : 0;
    }
    return alike;
  };
  EXPECT_LT(same(up_hollow), 10);
  EXPECT_GT(same(up_flange), 35);  // but for what goes back down to the hollow
  rough.scatter_sides = {rough.outline_mm.size() + 1};
  EXPECT_THAT(test::message_of<InputError>([&] { check(rough); }), HasSubstr("scatter_sides"));
}

TEST(SolidBottomFace, MeshesAreClosedAtAnyTolerance) {
  for (const double tolerance : {1e-2, kSurfaceTolerance, 1e-5})
    EXPECT_EQ(open_edges(*surface_mesh(two_faces(), tolerance)), 0U);
}

}  // namespace
}  // namespace lucerna
