// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <numeric>

#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/detectors/far_field_grid.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {
namespace {

TEST(CountedFarField, PartsAreOddAndNoFinerThanNeeded) {
  const auto parts = [](double c, double gamma, bool tent = false) {
    const FarFieldParts p = counted_parts({"far", c, gamma, tent});
    return std::pair(p.c, p.gamma);
  };
  EXPECT_EQ(parts(5.0, 1.0), std::pair(std::size_t{5}, std::size_t{3}));
  EXPECT_EQ(parts(2.5, 0.5), std::pair(std::size_t{3}, std::size_t{3}));
  EXPECT_EQ(parts(1.0, 0.25), std::pair(std::size_t{1}, std::size_t{1}));
  EXPECT_EQ(parts(360.0, 1.0), std::pair(std::size_t{1}, std::size_t{3}));
  EXPECT_EQ(parts(5.0, 1.0, true), std::pair(std::size_t{1}, std::size_t{1}));
}

// A direction's counted cell is one of those that its cell of the grid is made of.
TEST(CountedFarField, CellsAreUnionsOfCountedOnes) {
  const FarFieldDetector detector{"far", 5.0, 1.0};
  const FarFieldGrid grid(detector), counted = FarFieldGrid::counted(detector);
  EXPECT_EQ(counted.c_count(), 360u);
  EXPECT_EQ(counted.gamma_count(), 541u);
  int off = 0;
  for (std::uint64_t i = 0; i < 20'000; ++i) {
    Rng rng(3, i);
    const double u = 2.0 * rng.uniform() - 1.0, c = 2.0 * std::numbers::pi * rng.uniform();
    const Direction d = direction_from_type_c({c, std::acos(u)});
    const std::size_t cell = grid.cell(d), fine = counted.cell(d);
    const std::size_t from_c = (fine / 541 + 2) % 360 / 5, from_g = (fine % 541 + 1) / 3;
    if (from_c != cell / 181 || from_g != cell % 181) ++off;
  }
  EXPECT_EQ(off, 0);
}

TEST(CountedFarField, BothGridsHoldTheSameFlux) {
  Scene scene;
  scene.sources.push_back(
      {make_emitter({.kind = EmitterKind::sphere, .radius_mm = 1.0}), Frame(), std::nullopt});
  scene.far_fields = {{"far", 15.0, 2.5}};
  const TraceResult result = trace(scene, {.last_ray = 40'000});
  const FarField field = far_field(result, 0);
  const double sum = std::accumulate(field.flux.begin(), field.flux.end(), 0.0);
  const CountedSphere sphere = counted_far_field(result, 0);
  EXPECT_NEAR(sphere.zone_flux(0.0, 180.0).all(), sum, 1e-9 * sum);
  EXPECT_NEAR(out_flux(result).all(), sum, 1e-9 * sum);
  // Zones that end between cells of the grid, where cells of the counting grid end.
  double below = 0.0;
  for (std::size_t i = 0; i < field.flux.size(); ++i) below += i % 73 < 20 ? field.flux[i] : 0.0;
  EXPECT_NEAR(sphere.zone_flux(0.0, 19.5 * 2.5).all(), below, 1e-3 * sum);
}

}  // namespace
}  // namespace lucerna
