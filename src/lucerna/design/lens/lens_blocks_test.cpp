// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/lens_blocks.h"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "lucerna/source.h"

namespace lucerna {
namespace {

/// What becomes of the light, and where it goes, ray by ray.
struct LightSums {
  double all = 0.0, kept = 0.0, given_up = 0.0, out = 0.0;
  std::vector<Vec3> directions;

  void emitted(double flux) { all += flux; }
  void absorbed(double flux) { kept += flux; }
  void lost(double flux) { given_up += flux; }
  void left(const Ray& ray, double flux, int) {
    out += flux;
    directions.push_back(ray.direction.vec());
  }
};

/// A disk below a thick lens of some absorption.
Scene disk_below_lens() {
  Scene scene;
  PlacedSource disk;
  disk.rays = make_emitter({.kind = EmitterKind::disk, .radius_mm = 0.5});
  disk.spectrum = {{450.0F, 650.0F}, {1.0F, 1.0F}};
  scene.sources = {disk};
  Solid lens;
  lens.outline_mm = {{0.0, 2.0}, {8.0, 2.0}, {8.0, 4.0}, {5.0, 7.0}, {0.0, 8.0}};
  lens.absorption_per_mm = 0.01;
  scene.solids = {lens};
  return scene;
}

LightSums followed(const Scene& scene, LensSurface surface = LensSurface::triangles) {
  const LensBlocks blocks(scene, surface, 3);
  LightSums sums;
  RayBlock rays;
  for (std::uint64_t b = 0; b < 16; ++b) blocks.follow(b, rays, sums);
  return sums;
}

TEST(LensBlocks, NoLightIsLostButByItsCause) {
  const LightSums sums = followed(disk_below_lens());
  EXPECT_GT(sums.kept, 0.02 * sums.all);
  EXPECT_NEAR(sums.kept + sums.given_up + sums.out, sums.all, 1e-9 * sums.all);
}

// Triangles leave the curves by 1e-5 of the size: nearly every ray has the same fate. Light that is trapped
// does not.
TEST(LensBlocks, TrianglesAreNearlyTheExactSurfaces) {
  const LightSums exact = followed(disk_below_lens(), LensSurface::exact),
                  meshed = followed(disk_below_lens());
  EXPECT_EQ(meshed.all, exact.all);
  EXPECT_NE(meshed.directions, exact.directions);
  EXPECT_NEAR(meshed.kept, exact.kept, 0.02 * exact.kept);
  EXPECT_NEAR(meshed.out, exact.out, 1e-3 * exact.out);
}

// A lens whose index is 1.8 at all wavelengths is a lens of that index, whatever its constant index is; one
// that disperses is none.
TEST(LensBlocks, ARayMeetsTheIndexOfItsWavelength) {
  Scene constant = disk_below_lens(), even = constant, normal = constant;
  constant.solids[0].refractive_index = 1.8;
  even.solids[0].dispersion = std::make_shared<const Dispersion>(400.0, 700.0, std::vector{1.8, 1.8});
  normal.solids[0].dispersion = std::make_shared<const Dispersion>(400.0, 700.0, std::vector{1.82, 1.78});
  const LightSums expected = followed(constant);
  EXPECT_EQ(followed(even).directions, expected.directions);
  EXPECT_EQ(followed(even).kept, expected.kept);
  EXPECT_NE(followed(normal).directions, expected.directions);
}

}  // namespace
}  // namespace lucerna
