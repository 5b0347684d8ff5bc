// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/facet_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/kernels/facet_mirror.h"
#include "lucerna/trace/result/far_field_counts.h"
#include "tests/support/random_direction.h"

namespace lucerna {
namespace {

using test::random_direction;

Reflector facets_on_paraboloid(double radius_mm, const Aperture& aperture) {
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, aperture);
  return {std::make_shared<FacetedSurface>(base.surface, 7.0, radius_mm), aperture};
}

/// The nearest hit among all facets, each by itself: a bisection of FacetedSurface's heights over its square.
std::optional<double> nearest_of_all(const Reflector& mirror, const Ray& ray) {
  const auto& surface = dynamic_cast<const FacetedSurface&>(*mirror.surface);
  std::optional<double> nearest;
  for (int j = -8; j < 8; ++j) {
    for (int i = -8; i < 8; ++i) {
      const Facet k = surface.facet(i, j);
      const double p = 7.0, cx = (i + 0.5) * p, cy = (j + 0.5) * p, c = surface.curvature_per_mm();
      const auto f = [&](double t) {
        const Vec3 q = ray.at(t);
        const double x = q.x - cx, y = q.y - cy;
        return q.z - k.z_mm - k.dzdx * x - k.dzdy * y - 0.5 * c * (x * x + y * y);
      };
      double t0 = 0.0, t1 = 500.0;
      for (const auto& [o, d, low] : {std::array{ray.origin_mm.x, ray.direction.x(), i * p},
                                      std::array{ray.origin_mm.y, ray.direction.y(), j * p}}) {
        const double a = (low - o) / d, b = (low + p - o) / d;
        t0 = std::max(t0, std::min(a, b));
        t1 = std::min(t1, std::max(a, b));
      }
      if (!(t0 < t1)) continue;
      for (int n = 0; n < 400; ++n) {
        double a = t0 + (t1 - t0) * n / 400.0, b = t0 + (t1 - t0) * (n + 1) / 400.0;
        if ((f(a) >= 0.0) == (f(b) >= 0.0)) continue;
        const bool above = f(a) >= 0.0;
        for (int k2 = 0; k2 < 60; ++k2) ((f(0.5 * (a + b)) >= 0.0) == above ? a : b) = 0.5 * (a + b);
        const Vec3 q = ray.at(a);
        if (mirror.aperture.contains(q.x, q.y) && (!nearest || a < *nearest)) nearest = a;
      }
    }
  }
  return nearest;
}

TEST(FacetKernel, MeetsTheNearestFacet) {
  for (const double radius : {HUGE_VAL, 12.0, -40.0}) {
    const Reflector mirror = facets_on_paraboloid(radius, Aperture::circle(90.0, 8.0));
    const FacetMirror facets(*faceted(mirror), mirror.aperture);
    Rng rng(6, 0);
    int hits = 0, differ = 0;
    for (int i = 0; i < 1500; ++i) {
      const Ray ray{{100.0 * rng.uniform() - 50.0, 100.0 * rng.uniform() - 50.0, 70.0 * rng.uniform() - 20.0},
                    random_direction(rng)};
      const FacetHit hit = intersect_facets(facets.view(), ray.origin_mm, ray.direction.vec(), 0.0);
      const auto expected = nearest_of_all(mirror, ray);
      differ += hit.is_hit != expected.has_value();  // two roots within a 400th of a facet
      if (!hit.is_hit || !expected) continue;
      ++hits;
      EXPECT_NEAR(hit.t, *expected, 1e-9);
      const Vec3 p = ray.at(hit.t);
      const SurfacePoint s = mirror.surface->at(p.x, p.y);
      EXPECT_NEAR(p.z, s.z_mm, 1e-9);
      EXPECT_NEAR(hit.dzdx, s.dzdx, 1e-9);
      EXPECT_EQ(hit.front, ray.direction.z() - s.dzdx * ray.direction.x() - s.dzdy * ray.direction.y() < 0.0);
    }
    EXPECT_GT(hits, 300);
    EXPECT_LE(differ, 1) << radius;
  }
}

// Edges are exact: a hundredth of a micrometre on either side of one, light hits the facet of that side.
TEST(FacetKernel, EdgesAreSharp) {
  const Reflector mirror = facets_on_paraboloid(HUGE_VAL, Aperture::circle(90.0));
  const FacetMirror facets(*faceted(mirror), mirror.aperture);
  for (int i = -5; i <= 5; ++i) {
    for (const double side : {-1e-5, 1e-5}) {
      const Vec3 o{7.0 * i + side, 3.5, 60.0};
      const FacetHit hit = intersect_facets(facets.view(), o, {0.0, 0.0, -1.0}, 0.0);
      ASSERT_TRUE(hit.is_hit);
      EXPECT_NEAR(hit.dzdx, (7.0 * i + (side > 0.0 ? 3.5 : -3.5)) / 30.0, 1e-12);
    }
  }
}

// A ray that was just reflected and starts, by rounding, behind its facet, or beside it over the neighbour.
TEST(FacetKernel, RoundedStartsDoNotMeetTheirOwnFacet) {
  const Reflector mirror = facets_on_paraboloid(HUGE_VAL, Aperture::circle(90.0));
  const FacetMirror facets(*faceted(mirror), mirror.aperture);
  Rng rng(7, 0);
  int checked = 0;
  for (int i = 0; i < 20000; ++i) {
    const double edge = i % 2 == 0 ? 7.0 * rng.uniform() : 1e-7 * (rng.uniform() - 0.5);
    const double x = 14.0 + edge, y = 21.0 * rng.uniform();
    const Facet k = faceted(mirror)->facet(2, static_cast<std::int32_t>(y / 7.0));
    const double inside = std::max(x, 14.0 + 1e-9);
    const double z = k.z_mm + k.dzdx * (inside - 17.5) + k.dzdy * (y - 7.0 * std::floor(y / 7.0) - 3.5);
    const Vec3 o{x, y, z + 4e-6 * (rng.uniform() - 0.5)};
    const Direction d = Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, 1.0});
    const FacetHit exact = intersect_facets(facets.view(), {inside, y, z + 1e-8}, d.vec(), 0.0);
    const FacetHit hit = intersect_facets(facets.view(), o, d.vec(), 1e-5);
    ASSERT_EQ(hit.is_hit, exact.is_hit) << i;
    checked += hit.is_hit;
    if (hit.is_hit) {
      EXPECT_NEAR(hit.t, exact.t, 1e-3);
    }
  }
  EXPECT_LT(checked, 20000);
}

TEST(FacetKernel, RefusesTooManyFacets) {
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(90.0));
  EXPECT_THROW(FacetMirror(FacetedSurface(base.surface, 0.01, 1.0), base.aperture), InputError);
}

// Both engines meet the same facets: cells of the far field differ by rounding alone (they used to differ by
// facet edges smoothed over a cell of the fast engine's grid).
TEST(FacetKernel, EnginesAgreeToRounding) {
  Scene scene;
  scene.sources = {{make_emitter({.kind = EmitterKind::cylinder}), Frame(), std::nullopt}};
  scene.sources[0].world_from_source = Frame::from_axis(Direction{}, 0.0, {0, 0, 15});
  scene.reflectors = {{facets_on_paraboloid(30.0, Aperture::circle(90.0, 8.0)), Frame(), Reflectance(0.9)}};
  scene.far_fields = {{"far", 5.0, 1.0}};
  const TraceResult a = trace(scene, {.last_ray = 100000, .engine = EngineKind::reference});
  const TraceResult b = trace(scene, {.last_ray = 100000, .engine = EngineKind::fast});
  const FarField fa = far_field(a, 0), fb = far_field(b, 0);
  double moved = 0.0;
  for (std::size_t i = 0; i < fa.flux.size(); ++i) moved += std::abs(fa.flux[i] - fb.flux[i]);
  EXPECT_LT(moved, 2e-4 * ledger(a).emitted);
  EXPECT_NEAR(ledger(a).absorbed[1].second.mean, ledger(b).absorbed[1].second.mean, 2e-5 * ledger(a).emitted);
  EXPECT_GT(ledger(b).reflections_per_ray.mean, 0.7);
}

}  // namespace
}  // namespace lucerna
