// SPDX-License-Identifier: Apache-2.0
// Rays that trip tracers: along the axis, grazing, from and beyond the rims, on cell borders.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>

#include "lucerna/core/random.h"
#include "lucerna/reflector/faceted_surface.h"
#include "lucerna/reflector/spline_surface.h"
#include "lucerna/source/ray_set_source.h"
#include "lucerna/trace/trace.h"

namespace lucerna {
namespace {

std::vector<Reflector> families() {
  const Aperture round = Aperture::circle(64.0, 8.0), box = Aperture::rectangle(64.0, 48.0);
  Rng rng(4, 0);
  std::vector<double> c(10 * 10);
  for (double& x : c) x = rng.uniform();
  const Reflector base = conic_reflector(ConicPreset::parabola, 12.0, 0.0, round);
  return {
      base,
      conic_reflector(ConicPreset::ellipse, 20.0, 90.0, round),
      conic_reflector(ConicPreset::hyperbola, 12.0, 90.0, box),
      profile_reflector({{0.0, 0.0}, {10.0, 3.0}, {20.0, 4.0}, {32.0, 16.0}}, round),
      conic_trough(ConicPreset::parabola, 10.0, 0.0, box),
      {std::make_shared<SplineSurface>(Rectangle{-32, 32, -24, 24}, 10, 10, c, base.surface), box},
      {std::make_shared<FacetedSurface>(base.surface, 4.0, 25.0), round},
      deep_ellipse_reflector(20.0, 40.0, 40.0, 8.0),
      profile_trough({{0.0, 0.0}, {20.0, 8.0}, {28.0, 24.0}, {20.0, 40.0}}, Aperture::rectangle(40.0, 48.0))};
}

/// A ray of one of the kinds that the title names; cell borders are those of 64 cells over 64 mm.
Ray tricky(std::size_t i, const Reflector& mirror) {
  Rng rng(23, i);
  const auto any = [&rng](double half) { return half * (2.0 * rng.uniform() - 1.0); };
  const double rim = mirror.aperture.half_x_mm(), phi = 2.0 * std::numbers::pi * rng.uniform();
  const auto height = [&](double x, double y) { return mirror.surface->at(x, y).z_mm; };
  const Vec3 toward{any(1.0), any(1.0), any(1.0)};
  switch (i % 10) {
    case 0:  // down the axis' direction, on cell borders
      return {{std::floor(any(33.0)), std::floor(any(33.0)), 80.0}, Direction::from({0, 0, -1})};
    case 1:  // level, along a row of cells
      return {{-50.0, std::floor(any(33.0)), 30.0 * rng.uniform()}, Direction::from({1, 0, 0})};
    case 2:  // level, along the diagonal through vertices
      return {{-40.0, -40.0, 20.0 * rng.uniform()}, Direction::from({1, 1, 0})};
    case 3: {  // tangent at a point of the surface
      const double x = any(20.0), y = any(20.0);
      const SurfacePoint s = mirror.surface->at(x, y);
      const Vec3 along{std::cos(phi), std::sin(phi), s.dzdx * std::cos(phi) + s.dzdy * std::sin(phi)};
      return {Vec3{x, y, s.z_mm + 1e-4 * any(1.0)} - 30.0 * along, Direction::from(along)};
    }
    case 4:  // from the rim
      return {{rim * std::cos(phi), rim * std::sin(phi), height(rim * std::cos(phi), rim * std::sin(phi))},
              Direction::from(toward)};
    case 5:  // from outside, at the rim
      return {{90.0 * std::cos(phi), 90.0 * std::sin(phi), 50.0 * rng.uniform()},
              Direction::from({-std::cos(phi), -std::sin(phi), 0.3 * any(1.0)})};
    case 6: {  // from the surface itself
      const double x = any(20.0), y = any(20.0);
      return {{x, y, height(x, y)}, Direction::from(toward)};
    }
    case 7:  // from below
      return {{any(30.0), any(30.0), -40.0}, Direction::from({any(0.2), any(0.2), 1.0})};
    case 8:  // nearly along the axis
      return {{any(30.0), any(30.0), 80.0}, Direction::from({any(1e-7), any(1e-12), -1.0})};
    default:  // through the hole's rim
      return {{4.0 * std::cos(phi), 4.0 * std::sin(phi), 60.0}, Direction::from({0, 0, -1})};
  }
}

// No crash, no not-a-number, energy closed to the unit, and no ray lost for numbers' sake.
TEST(Robustness, TrickyRaysThroughEveryFamily) {
  int family = 0;
  for (const Reflector& mirror : families()) {
    auto set = std::make_shared<RaySet>();
    set->header.set_flux(1.0);
    const std::size_t n = 50000;
    set->rays.resize(n, 0);
    for (std::size_t i = 0; i < n; ++i) {
      set->rays.set(i, tricky(i, mirror));
      set->rays.weight[i] = 1.0F;
    }
    Scene scene{{{std::make_shared<RaySetSource>(set, "tricky"), Frame(), std::nullopt}},
                {{mirror, Frame(), Reflectance(0.9)}},
                {{"far", 5.0, 1.0}}};
    scene.ray_detectors = {{}};
    for (const EngineKind engine : {EngineKind::reference, EngineKind::fast}) {
      const TraceResult result = trace(scene, {.max_bounces = 1000, .engine = engine, .cells = 64});
      const Ledger l = ledger(result);
      EXPECT_EQ(l.lost_rays, 0u) << "family " << family;
      EXPECT_GT(l.reflections_per_ray, 0.2) << "family " << family;
      for (const Tally& t : result.replicates) {
        EXPECT_EQ(t.emitted,
                  t.out_direct + t.out_reflected + t.absorbed[0] + t.absorbed[1] + t.lost[0] + t.lost[1]);
      }
      for (std::size_t i = 0; i < result.out_rays.size(); ++i) {
        const Ray r = result.out_rays.ray(i);
        ASSERT_TRUE(is_finite(r.origin_mm) && std::abs(length(r.direction.vec()) - 1.0) < 1e-5);
      }
    }
    ++family;
  }
}

// Coordinates that are not numbers are counted as lost, by cause, and nothing else changes.
TEST(Robustness, NotANumberIsCountedAsLost) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1.0);
  set->rays.resize(1000, 0);
  for (std::size_t i = 0; i < 1000; ++i) {
    const double x = i % 100 == 7 ? std::nan("") : (i % 100 == 8 ? HUGE_VAL : 1.0);
    set->rays.set(i, {{x, 2.0, 40.0}, Direction::from({0, 0, -1})});
    set->rays.weight[i] = 1.0F;
  }
  const Scene scene{{{std::make_shared<RaySetSource>(set, "bad"), Frame(), std::nullopt}},
                    {{families()[0], Frame(), Reflectance(1.0)}},
                    {{"far", 5.0, 1.0}}};
  for (const EngineKind engine : {EngineKind::reference, EngineKind::fast}) {
    const Ledger l = ledger(trace(scene, {.engine = engine, .cells = 64}));
    EXPECT_EQ(l.lost_rays, 20u);
    EXPECT_EQ(l.lost[1].first, "not_finite");
    EXPECT_NEAR(l.lost[1].second.mean, 0.02, 1e-9);
  }
}

}  // namespace
}  // namespace lucerna
