// SPDX-License-Identifier: Apache-2.0
#include "lucerna/reflector/reflector.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/core/error.h"
#include "lucerna/core/random.h"
#include "lucerna/reflector/height_mipmap.h"

namespace lucerna {
namespace {

std::vector<Reflector> all_families() {
  const Aperture round = Aperture::circle(50.0, 6.0);
  return {conic_reflector(ConicPreset::parabola, 15.0, 0.0, round),
          conic_reflector(ConicPreset::ellipse, 12.0, 80.0, round),
          conic_reflector(ConicPreset::hyperbola, 12.0, 80.0, Aperture::rectangle(40.0, 60.0)),
          profile_reflector({{0.0, 0.0}, {8.0, 1.5}, {15.0, 3.0}, {25.0, 12.0}}, round)};
}

TEST(Reflector, GradientsAreThoseOfTheHeight) {
  Rng rng(5, 0);
  const double e = 1e-5;
  for (const Reflector& r : all_families()) {
    for (int i = 0; i < 200; ++i) {
      const double x = 30.0 * rng.uniform() - 15.0, y = 30.0 * rng.uniform() - 15.0;
      const SurfacePoint s = r.surface->at(x, y);
      EXPECT_NEAR(s.dzdx, (r.surface->at(x + e, y).z_mm - r.surface->at(x - e, y).z_mm) / (2.0 * e), 1e-8);
      EXPECT_NEAR(s.dzdy, (r.surface->at(x, y + e).z_mm - r.surface->at(x, y - e).z_mm) / (2.0 * e), 1e-8);
    }
  }
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
    EXPECT_LT(tree.cell(5, 3, 3).high_mm - tree.cell(5, 3, 3).low_mm, 8.0);
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
