// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/height_field/height_mipmap.h"
#include "lucerna/optics/shapes/faceted_surface.h"
#include "lucerna/optics/shapes/spline_surface.h"
#include "lucerna/random.h"

namespace lucerna {
namespace {

SplineSurface bumps(std::shared_ptr<const HeightSurface> base) {
  Rng rng(1, 0);
  std::vector<double> c(std::size_t{9} * 7);
  for (double& x : c) x = 3.0 * rng.uniform();
  return {{-25.0, 25.0, -25.0, 25.0}, 9, 7, c, std::move(base)};
}

std::vector<Reflector> all_families() {
  const Aperture round = Aperture::circle(50.0, 6.0);
  return {
      conic_reflector(ConicPreset::parabola, 15.0, 0.0, round),
      conic_reflector(ConicPreset::ellipse, 12.0, 80.0, round),
      conic_reflector(ConicPreset::hyperbola, 12.0, 80.0, Aperture::rectangle(40.0, 60.0)),
      profile_reflector({{0.0, 0.0}, {8.0, 1.5}, {15.0, 3.0}, {25.0, 12.0}}, round),
      conic_trough(ConicPreset::parabola, 10.0, 0.0, Aperture::rectangle(40.0, 60.0)),
      profile_trough({{0.0, 0.0}, {8.0, 1.5}, {15.0, 3.0}, {25.0, 12.0}}, Aperture::rectangle(50.0, 30.0)),
      {std::make_shared<SplineSurface>(bumps(nullptr)), round},
      {std::make_shared<SplineSurface>(
           bumps(conic_reflector(ConicPreset::parabola, 15.0, 0.0, round).surface)),
       round},
      {std::make_shared<FacetedSurface>(conic_reflector(ConicPreset::parabola, 15.0, 0.0, round).surface, 5.0,
                                        12.0),
       round}};
}

TEST(Reflector, GradientsAreThoseOfTheHeight) {
  Rng rng(5, 0);
  const double e = 1e-5;
  for (const Reflector& r : all_families()) {
    for (int i = 0; i < 200; ++i) {
      const double x = 30.0 * rng.uniform() - 15.0, y = 30.0 * rng.uniform() - 15.0;
      if (std::abs(std::remainder(x, 5.0)) < 1e-4 || std::abs(std::remainder(y, 5.0)) < 1e-4) continue;
      const SurfacePoint s = r.surface->at(x, y);
      EXPECT_NEAR(s.dzdx, (r.surface->at(x + e, y).z_mm - r.surface->at(x - e, y).z_mm) / (2.0 * e), 1e-8);
      EXPECT_NEAR(s.dzdy, (r.surface->at(x, y + e).z_mm - r.surface->at(x, y - e).z_mm) / (2.0 * e), 1e-8);
    }
  }
}

TEST(SplineSurface, GoesThroughTheHeightsAndReproducesACubic) {
  const auto cubic = [](double x, double y) {
    return 0.01 * x * x * x - 0.2 * x * y + 0.03 * y * y + 0.001 * x * y * y * y;
  };
  const Rectangle region{-6.0, 8.0, -5.0, 5.0};
  std::vector<double> heights;
  for (int j = 0; j < 11; ++j) {
    for (int i = 0; i < 8; ++i) heights.push_back(cubic(-6.0 + 2.0 * i, -5.0 + j));
  }
  const SplineSurface s = SplineSurface::through(region, 8, 11, heights);
  for (double x = -6.0; x <= 8.0; x += 0.37) {
    for (double y = -5.0; y <= 5.0; y += 0.41) EXPECT_NEAR(s.at(x, y).z_mm, cubic(x, y), 1e-11);
  }
}

TEST(SplineSurface, RefusesBadInput) {
  const Rectangle r{0.0, 1.0, 0.0, 1.0};
  EXPECT_THROW(SplineSurface(r, 3, 5, std::vector<double>(15)), InputError);
  EXPECT_THROW(SplineSurface(r, 4, 5, std::vector<double>(19)), InputError);
  EXPECT_THROW(SplineSurface(r, 4, 4, std::vector<double>(16, std::nan(""))), InputError);
  EXPECT_THROW(SplineSurface::through(r, 4, 4, std::vector<double>(16, INFINITY)), InputError);
}

TEST(FacetedSurface, TouchesItsBaseAtTheCentres) {
  const Reflector base = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(50.0));
  const FacetedSurface flat(base.surface, 5.0, INFINITY), pillow(base.surface, 5.0, 20.0);
  EXPECT_EQ(flat.at(2.5, -7.5).z_mm, base.surface->at(2.5, -7.5).z_mm);
  EXPECT_EQ(flat.at(4.9, -5.1).dzdx, base.surface->at(2.5, -7.5).dzdx);
  EXPECT_NEAR(flat.at(2.5, -7.5).z_mm - pillow.at(4.5, -7.5).z_mm + 2.0 * flat.at(2.5, -7.5).dzdx, 0.1,
              1e-12);
  EXPECT_THROW(FacetedSurface(base.surface, 0.0, 10.0), InputError);
  EXPECT_THROW(FacetedSurface(base.surface, 5.0, 0.0), InputError);
}

TEST(Reflector, RefusesAnApertureThatTheProfileDoesNotFill) {
  EXPECT_THROW(profile_reflector({{0.0, 0.0}, {20.0, 5.0}}, Aperture::circle(50.0)), InputError);
  EXPECT_THROW(profile_reflector({{4.0, 0.0}, {25.0, 5.0}}, Aperture::circle(50.0, 6.0)), InputError);
}

// What makes the tree safe: every cell's range holds the surface in it, and every parent holds its children.
TEST(HeightMipmap, HoldsTheSurfaceAtEveryLevel) {
  Rng rng(9, 0);
  for (const Reflector& r : all_families()) {
    const HeightMipmap tree(r, 5);
    for (int i = 0; i < 5000; ++i) {
      const Rectangle& region = tree.region();
      const double x = region.x0_mm + (region.x1_mm - region.x0_mm) * rng.uniform();
      const double y = region.y0_mm + (region.y1_mm - region.y0_mm) * rng.uniform();
      if (!r.aperture.contains(x, y)) continue;
      const double z = r.surface->at(x, y).z_mm;
      for (int level = 0; level <= 5; ++level) {
        const double n = std::ldexp(1.0, level);
        const auto ix = static_cast<std::size_t>((x - region.x0_mm) / (region.x1_mm - region.x0_mm) * n);
        const auto iy = static_cast<std::size_t>((y - region.y0_mm) / (region.y1_mm - region.y0_mm) * n);
        EXPECT_LE(tree.cell(level, ix, iy).low_mm, z);
        EXPECT_GE(tree.cell(level, ix, iy).high_mm, z);
      }
    }
    EXPECT_LT(tree.cell(5, 7, 7).high_mm - tree.cell(5, 7, 7).low_mm, 8.0);
  }
}

TEST(HeightMipmap, CellsOffTheMirrorAreEmpty) {
  const HeightMipmap tree(conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(50.0, 10.0)), 5);
  EXPECT_GT(tree.cell(5, 0, 0).low_mm, tree.cell(5, 0, 0).high_mm);
  EXPECT_GT(tree.cell(5, 16, 16).low_mm, tree.cell(5, 16, 16).high_mm);
  EXPECT_LT(tree.cell(5, 16, 24).low_mm, tree.cell(5, 16, 24).high_mm);
}

}  // namespace
}  // namespace lucerna
