// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_flight.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "lucerna/material.h"
#include "lucerna/random.h"
#include "lucerna/trace/engines/glass_tracer.h"
#include "tests/support/spline_face.h"
#include "tests/support/turned_outlines.h"

namespace lucerna {
namespace {

/// A ball, clear.
Solid ball_solid() {
  Solid s;
  s.name = "ball";
  s.outline_mm = test::turned_outlines()[1];
  s.refractive_index = 1.5;
  s.absorption_per_mm = 0.01;
  return s;
}

/// A lens with a face at its top and one in a hollow.
Solid faced_solid_above(double z_mm) {
  Solid s;
  s.name = "lens";
  s.outline_mm = {{6, 1}, {6, 0}, {10, 0}, {10, 2}};
  s.face = test::spline_face([](double x, double y) { return 5.0 - 0.02 * (x * x + 0.5 * y * y); }, 11.0, 20);
  s.bottom_face = test::spline_face([](double x, double y) { return 2.0 - 0.02 * (x * x + y * y); }, 7.0, 20);
  s.refractive_index = 1.6;
  s.world_from_solid = Frame::rotation(Direction::from({0.1, 0.2, 1.0}), 0.3) *
                       Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, z_mm});
  return s;
}

/// Light that meets any of the bodies, first from anywhere, then what is left of it: the same one by one and
/// together, bit by bit.
void expect_same_light(const GlassTracer& tracer, double reach_mm) {
  constexpr std::size_t kRays = 700;  // more than one batch, and not a whole number of them
  std::vector<Ray> rays;
  Rng rng(21, 0);
  for (std::size_t i = 0; i < kRays; ++i) rays.push_back(test::ray_across(rng, reach_mm));
  std::size_t met = 0, followed = 0;
  for (int bounce = 0; bounce < 3 && !rays.empty(); ++bounce) {
    std::vector<double> t_max_mm(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) t_max_mm[i] = i % 5 == 0 ? 3.0 : 1e30;
    const std::vector<double> limits_mm = t_max_mm;
    std::vector<std::optional<GlassHit>> hits(rays.size());
    tracer.first_hits(rays, bounce > 0, t_max_mm, hits);
    std::vector<GlassRay> on;
    for (std::size_t i = 0; i < rays.size(); ++i) {
      const auto one = tracer.first_hit(rays[i], limits_mm[i], bounce > 0);
      ASSERT_EQ(one.has_value(), hits[i].has_value()) << i;
      if (!one) continue;
      ASSERT_EQ(hits[i]->t_mm, one->t_mm) << i;
      ASSERT_EQ(hits[i]->glass, one->glass) << i;
      ASSERT_EQ(hits[i]->part, one->part) << i;
      ASSERT_EQ(hits[i]->u, one->u) << i;
      ASSERT_EQ(t_max_mm[i], one->t_mm) << i;
      on.push_back({rays[i], *one, {5, i, bounce}, i % 2 == 0 ? 450.0F : 0.0F});
    }
    met += on.size();
    std::vector<GlassPassage> passages(on.size());
    tracer.pass(on, passages);
    rays.clear();
    for (std::size_t i = 0; i < on.size(); ++i) {
      const GlassPassage one = tracer.pass(on[i].ray, on[i].hit, on[i].key, on[i].wavelength_nm);
      ASSERT_EQ(passages[i].throughput, one.throughput) << i;
      ASSERT_EQ(passages[i].transmitted, one.transmitted) << i;
      ASSERT_EQ(passages[i].lost, one.lost) << i;
      ASSERT_EQ(passages[i].ray.origin_mm, one.ray.origin_mm) << i;
      ASSERT_EQ(passages[i].ray.direction, one.ray.direction) << i;
      if (one.throughput > 0.0 && !one.lost) rays.push_back(one.ray);
    }
    followed += rays.size();
  }
  EXPECT_GT(met, 100U);
  EXPECT_GT(followed, 90U);
}

TEST(SolidFlight, ABallTakesManyRaysAsItTakesOne) {
  expect_same_light(GlassTracer({}, {ball_solid()}), 15.0);
}

TEST(SolidFlight, SoDoBodiesWithFacesAndOnesOfTriangles) {
  Solid mesh = ball_solid();
  mesh.mesh = surface_mesh(ball_solid(), 1e-3);
  mesh.outline_mm.clear();
  mesh.world_from_solid = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {30, 0, 0});
  expect_same_light(GlassTracer({}, {ball_solid(), faced_solid_above(12.0), mesh}), 20.0);
}

TEST(SolidFlight, SoDoRoughSidesAndMediaThatDisperse) {
  Solid s = ball_solid();
  s.scatter = Scatter({gaussian_lobe(0.3, 0.1)});
  s.dispersion = std::make_shared<const Dispersion>(dispersion("pmma"));
  expect_same_light(GlassTracer({}, {s}), 15.0);
}

TEST(SolidFlight, SoDoPlatesBesideBodies) {
  CoverGlass plate;
  plate.name = "plate";
  plate.aperture = Aperture::circle(60.0);
  plate.thickness_mm = 2.0;
  plate.world_from_glass = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 14});
  expect_same_light(GlassTracer({plate}, {ball_solid()}), 15.0);
}

}  // namespace
}  // namespace lucerna
