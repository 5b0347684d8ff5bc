// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/lens_array_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "tests/support/random_direction.h"

namespace lucerna {
namespace {

constexpr double kDisk_mm = 12.0;

std::vector<LensArray> arrays() {
  return {{.pitch_mm = 1.5, .radius_mm = 1.3, .apex_mm = 1.0},
          {.pitch_mm = 0.9, .is_hexagonal = true, .radius_mm = 2.0, .conic = -1.0, .apex_mm = 1.0},
          {.pitch_mm = 2.0, .is_hexagonal = true, .radius_mm = -1.6, .conic = 0.4, .apex_mm = -0.5},
          {.pitch_mm = 1.0, .radius_mm = 0.8, .conic = -4.0, .apex_mm = 0.0}};
}

/// Height of a ray above the surface.
double above(const LensArraySurface& surface, const Ray& ray, double t) {
  const Vec3 p = ray.at(t);
  return p.z - surface.at(p.x, p.y).z_mm;
}

/// The first change of sign within the disk in small steps; infinity if there is none.
double first_change(const LensArraySurface& surface, const Ray& ray, double reach_mm) {
  constexpr int kSteps = 20'000;
  double before = above(surface, ray, 0.0);
  for (int i = 1; i <= kSteps; ++i) {
    const double t = reach_mm * i / kSteps, here = above(surface, ray, t);
    const Vec3 p = ray.at(t);
    if ((here >= 0.0) != (before >= 0.0) && std::hypot(p.x, p.y) < kDisk_mm / 2.0) return t;
    before = here;
  }
  return HUGE_VAL;
}

// Rays from everywhere about the array, many of them along it through tens of lenslets.
TEST(LensArrayWalk, FindsTheFirstPointOfTheSurface) {
  const Aperture disk = Aperture::circle(kDisk_mm);
  constexpr double kReach_mm = 16.0;
  for (const LensArray& array : arrays()) {
    const LensArraySurface surface(array);
    Rng rng(5, 0);
    int hits = 0;
    for (int i = 0; i < 400; ++i) {
      Vec3 to = test::random_direction(rng).vec();
      if (i % 2 == 0) to.z *= 0.05;
      const Ray ray{{8.0 * rng.uniform() - 4.0, 8.0 * rng.uniform() - 4.0, 3.0 * rng.uniform() - 1.5},
                    Direction::from(to)};
      const auto hit = first_lens_array_hit(surface, disk, ray);
      const double expected = first_change(surface, ray, kReach_mm);
      if (hit && hit->t_mm < kReach_mm) {
        ++hits;
        EXPECT_NEAR(above(surface, ray, hit->t_mm), 0.0, 1e-10);
        // A graze may be shorter than a step.
        EXPECT_LE(hit->t_mm, expected + 1e-9);
        const SurfacePoint at = surface.at(ray.at(hit->t_mm).x, ray.at(hit->t_mm).y);
        EXPECT_NEAR(angle_between(hit->normal, Direction::from({-at.dzdx, -at.dzdy, 1.0})), 0.0, 1e-6);
      } else {
        EXPECT_EQ(expected, HUGE_VAL) << i;
      }
    }
    EXPECT_GT(hits, 80);
  }
}

/// A plate of 1 mm with hyperboloids on it, which send parallel light to one point: conic = -n^2.
Solid array_plate(double pitch_mm, bool is_hexagonal) {
  Solid s;
  s.outline_mm = {{0, 0}, {10, 0}, {10, 0.2}};
  s.face = lens_array(
      {.pitch_mm = pitch_mm, .is_hexagonal = is_hexagonal, .radius_mm = 2.0, .conic = -2.25, .apex_mm = 1.0});
  s.refractive_index = 1.5;
  return s;
}

// Every lenslet sends parallel light to its own focus, R / (n - 1) = 4 mm above its apex.
TEST(LensArrayWalk, EveryLensletHasItsFocus) {
  for (const bool is_hexagonal : {false, true}) {
    const Solid plate = array_plate(0.5, is_hexagonal);
    const SolidTracer tracer({plate});
    const ArrayCells cells(0.5, is_hexagonal);
    Rng rng(6, 0);
    int through = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
      const double x = 12.0 * rng.uniform() - 6.0, y = 12.0 * rng.uniform() - 6.0;
      const ArrayPoint c = cells.centre(x, y);
      const Ray up{{x, y, -5.0}, Direction::from({0.0, 0.0, 1.0})};
      const auto hit = tracer.first_hit(up, 1e9, false);
      ASSERT_TRUE(hit);
      int places = 0;
      const GlassPassage p = tracer.pass(up, *hit, {1, i, 0}, 0.0F, [&](const Vec3&) { ++places; });
      if (!p.transmitted || places != 2) continue;  // some of it is reflected
      ++through;
      const Vec3 at = p.ray.at((5.0 - p.ray.origin_mm.z) / p.ray.direction.z());
      EXPECT_LT(std::hypot(at.x - c.x, at.y - c.y), 1e-8);
    }
    EXPECT_GT(through, 1700);
  }
}

TEST(LensArrayWalk, NoLightIsLostInAPlateOfManyLenslets) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 3.0;
  Scene scene;
  scene.sources = {{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -2}), {}}};
  scene.far_fields.emplace_back();
  scene.solids = {array_plate(0.1, true)};
  TraceOptions how;
  how.last_ray = 1 << 17;
  const Ledger l = ledger(trace(scene, how));
  EXPECT_NEAR(l.out_direct.mean + l.out_reflected.mean + l.all_lost.mean, l.emitted, 1e-9 * l.emitted);
  EXPECT_LT(static_cast<double>(l.lost_rays), 1e-3 * static_cast<double>(l.rays))
      << "kept by total reflection";
}

}  // namespace
}  // namespace lucerna
