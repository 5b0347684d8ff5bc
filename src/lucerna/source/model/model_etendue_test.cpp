// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/model/model_etendue.h"

#include <gtest/gtest.h>

#include <numbers>
#include <optional>

#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/source/adaptive/compression/adaptive_compress.h"
#include "lucerna/source/clusters/cluster_compress.h"
#include "lucerna/source/emitters/draw_rays.h"

namespace lucerna {
namespace {

RaySet rays_of_kind(EmitterKind kind, std::size_t n) {
  EmitterOptions options;
  options.kind = kind;
  const auto source = make_emitter(options);
  RaySet set;
  set.header.set_flux(source->flux());
  set.rays = draw_rays(*source, Sequence(SequenceKind::random, 1), n);
  return set;
}

// A Lambertian disk of 1 mm: all of its étendue pi^2 r^2 is equally bright, half of the flux needs half of
// it.
TEST(ModelEtendueStatistical, OfADiskIsTheKnownOne) {
  constexpr double kWhole = std::numbers::pi * std::numbers::pi;
  const RaySet rays = rays_of_kind(EmitterKind::disk, 30'000);
  const EtendueCurve adaptive = etendue_curve(*compress_adaptive(rays, {}));
  EXPECT_NEAR(adaptive.at(0.5) / (0.5 * kWhole), 1.0, 0.05);
  EXPECT_NEAR(adaptive.at(0.99) / (0.99 * kWhole), 1.0, 0.05);
  EXPECT_NEAR(searched_etendue_curve(rays.rays).at(0.5) / (0.5 * kWhole), 1.0, 0.06);
  // Clusters leave steps of luminance, and some light beyond the rim.
  const EtendueCurve clusters = etendue_curve(*compress_clusters(rays), 1024);
  EXPECT_NEAR(clusters.at(0.5) / (0.5 * kWhole), 1.0, 0.3);
  EXPECT_FALSE(clusters.degenerate());
}

/// Two disks of 1 mm, 6 mm apart: their rays in turns, or by chance.
RayBlock two_disks(bool in_turns) {
  RayBlock rays = rays_of_kind(EmitterKind::disk, 40'000).rays;
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const bool right = in_turns ? i % 2 == 0 : Rng(5, i).uniform() < 0.5;
    rays.x_mm[i] += right ? 3.0f : -3.0f;
  }
  return rays;
}

// Halves in turns would be two lamps, of which one says nothing of the other: every share had the étendue of
// one disk.
TEST(ModelEtendueStatistical, OfDiesThatTakeTurnsIsThatOfAll) {
  constexpr double kWhole = 2.0 * std::numbers::pi * std::numbers::pi;
  for (const bool in_turns : {true, false}) {
    const RayBlock rays = two_disks(in_turns);
    const EtendueCurve curve = searched_etendue_curve(rays);
    for (const double share : {0.5, 0.9}) {
      EXPECT_NEAR(curve.at(share) / (share * kWhole), 1.0, 0.1) << in_turns << share;
      EXPECT_NEAR(etendue_curve(rays).at(share) / (share * kWhole), 1.0, 0.5) << in_turns << share;
    }
  }
}

// A coil's étendue is that of its wire's surface, pi times 17.3 mm^2, less where windings overlap; a tree on
// the plane of the focus finds twice as much, since no box holds a wire.
TEST(ModelEtendueStatistical, OfACoilNeedsItsSupport) {
  const RaySet rays = rays_of_kind(EmitterKind::filament, 130'000);
  const double wire = std::numbers::pi * 17.3, found = searched_etendue_curve(rays.rays).at(0.5);
  EXPECT_GT(found, 0.35 * wire);
  EXPECT_LT(found, 0.70 * wire);
  EXPECT_GT(etendue_curve(rays.rays).at(0.5), 1.5 * found);
}

// Lambertian light of a convex body: all of its étendue, pi times its surface, is equally bright.
TEST(ModelEtendueStatistical, OfEmittersWithALuminanceIsTheKnownOne) {
  constexpr double kPi2 = std::numbers::pi * std::numbers::pi;
  const auto share = [](EmitterKind kind, double whole_mm2sr, double flux) {
    EmitterOptions options;
    options.kind = kind;
    const std::optional<EtendueCurve> curve = known_etendue_curve(*make_emitter(options));
    return curve ? curve->at(flux) / (flux * whole_mm2sr) : 0.0;
  };
  for (const double flux : {0.1, 0.5, 0.99}) {
    EXPECT_NEAR(share(EmitterKind::disk, kPi2, flux), 1.0, 0.02) << flux;
    EXPECT_NEAR(share(EmitterKind::sphere, 4.0 * kPi2, flux), 1.0, 0.02) << flux;
  }
  EmitterOptions filament;
  filament.kind = EmitterKind::filament;
  EXPECT_FALSE(known_etendue_curve(*make_emitter(filament)).has_value());
}

TEST(ModelEtendue, OfAnyNumberOfRaysIsSearched) {
  for (std::size_t n = 1; n < 8; ++n)
    EXPECT_GE(searched_etendue_curve(rays_of_kind(EmitterKind::disk, n).rays).at(0.5), 0.0) << n;
}

TEST(ModelEtendue, IsNoneForRaysFromOnePoint) {
  EXPECT_TRUE(etendue_curve(*compress_adaptive(rays_of_kind(EmitterKind::point, 5'000), {})).degenerate());
  EXPECT_TRUE(etendue_curve(*compress_clusters(rays_of_kind(EmitterKind::point, 5'000))).degenerate());
}

}  // namespace
}  // namespace lucerna
