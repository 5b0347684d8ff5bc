// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/glass_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"

namespace lucerna {
namespace {

CoverGlass clear(double index = 1.5) {
  return {.aperture = Aperture::circle(100.0), .thickness_mm = 4.0, .refractive_index = index};
}

Ray ray_down(double angle_deg, const Vec3& from) {
  return {from, Direction::from({std::sin(radians(angle_deg)), 0.0, -std::cos(radians(angle_deg))})};
}

// n = 1.5: one interface returns ((n - 1) / (n + 1))^2 = 0.04, a clear plate lets (1 - r) / (1 + r) through.
TEST(CoverGlass, NormalIncidence) {
  EXPECT_NEAR(glass_shares(clear(), 1.0).transmitted, 0.96 / 1.04, 1e-15);
  CoverGlass grey = clear();
  grey.absorption_per_mm = 0.1;
  const double a = std::exp(-0.4), t = 0.96 * 0.96 * a / (1.0 - 0.0016 * a * a);
  EXPECT_NEAR(glass_shares(grey, 1.0).transmitted, t, 1e-15);
  EXPECT_NEAR(glass_shares(grey, 1.0).reflected, 0.04 * (1.0 + a * t), 1e-15);
}

TEST(CoverGlass, SharesSumToOneAndNothingPassesAtGrazing) {
  for (double index = 1.0; index < 4.0; index += 0.37) {
    for (double cosine = 0.0; cosine <= 1.0; cosine += 0.01) {
      const GlassShares s = glass_shares(clear(index), cosine);
      EXPECT_NEAR(s.absorbed, 0.0, 1e-14) << "clear glass keeps nothing";
      EXPECT_GE(s.transmitted, 0.0);
    }
    EXPECT_EQ(glass_shares(clear(index), 0.0).transmitted, 0.0);
  }
  EXPECT_EQ(glass_shares(clear(1.0), 0.3).transmitted, 1.0) << "a plate of air";
}

TEST(CoverGlass, BrewstersAngleReturnsNoParallelLight) {
  const CoverGlassView cover_glass{true, 50.0, 50.0, 4.0, 1.5, 0.0};
  const CoverGlassAtAngle at = cover_glass_at_angle(cover_glass, std::cos(std::atan(1.5)));
  EXPECT_NEAR(at.p.reflected, 0.0, 1e-30);
  EXPECT_NEAR(at.p.transmitted, 1.0, 1e-15);
  EXPECT_GT(at.s.reflected, 0.2);
}

// Light let through at once leaves beside its line by d sin(i) (1 - cos(i) / (n cos(t))).
TEST(CoverGlass, ShiftsALineByItsThickness) {
  const CoverGlassView cover_glass{true, 50.0, 50.0, 4.0, 1.5, 0.0};
  for (const double angle : {0.0, 20.0, 50.0, 80.0}) {
    const Ray ray = ray_down(angle, {-3.0, 1.0, 10.0});
    const CoverGlassEntry entry = cover_glass_entry(cover_glass, ray.origin_mm, ray.direction.vec());
    ASSERT_TRUE(entry.is_hit && !entry.edge);
    EXPECT_NEAR(ray.at(entry.t_mm).z, 4.0, 1e-13);
    const CoverGlassOutcome out =
        pass_cover_glass(cover_glass, ray.origin_mm, ray.direction.vec(), entry, GlassSides::both, 0.0, 0.0);
    ASSERT_TRUE(out.transmitted);
    EXPECT_EQ(out.direction.z, ray.direction.z());
    EXPECT_EQ(out.origin_mm.z, 0.0);
    const double si = std::sin(radians(angle)), ci = std::cos(radians(angle));
    const double ct = std::sqrt(1.0 - si * si / 2.25);
    const Vec3 off = out.origin_mm - ray.origin_mm;
    EXPECT_NEAR(length(cross(off, ray.direction.vec())), 4.0 * si * (1.0 - ci / (1.5 * ct)), 1e-12);
  }
}

// The order of a pass is drawn as often as the series says: mean number of ways through the glass, against
// the sum over orders. 1e-6 false alarms at 4.9 sigma; always one way (no inter-reflection) is 60 sigma off.
TEST(CoverGlassStatistical, WaysThroughTheGlassFollowTheSeries) {
  const CoverGlassView cover_glass{true, 5000.0, 5000.0, 4.0, 2.5, 0.02};
  const Ray ray = ray_down(30.0, {0.0, 0.0, 4.0});
  const CoverGlassEntry entry = cover_glass_entry(cover_glass, {0, 0, 5.0}, ray.direction.vec());
  const CoverGlassAtAngle at = cover_glass_at_angle(cover_glass, std::abs(ray.direction.z()));
  const double unit = 4.0 * 0.5 / (2.5 * at.cos_inside);  // sideways, one way
  double expected[2] = {0.0, 0.0};
  for (const PlateShares& s : {at.s, at.p}) {
    const double r = s.interface, a = s.passage, once = (1.0 - r) * (1.0 - r);
    for (int k = 0; k < 60; ++k) {
      expected[1] += (2 * k + 1) * once * a * std::pow(r * a, 2 * k);
      expected[0] += (2 * k + 2) * once * r * a * a * std::pow(r * a, 2 * k);
    }
  }
  double sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
  const int n = 200000;
  Rng rng(8, 0);
  const double start = 0.5 * entry.t_mm;
  for (int i = 0; i < n; ++i) {
    const double u = rng.uniform(), v = rng.uniform();
    const CoverGlassOutcome out =
        pass_cover_glass(cover_glass, {0, 0, 5.0}, ray.direction.vec(), entry, GlassSides::both, u, v);
    const double ways = (out.origin_mm.x - start) / unit * 2.0 * out.throughput;
    sum[out.transmitted ? 1 : 0] += ways;
    square[out.transmitted ? 1 : 0] += ways * ways;
  }
  for (int k = 0; k < 2; ++k) {
    const double mean = sum[k] / n, sigma = std::sqrt((square[k] / n - mean * mean) / n);
    EXPECT_NEAR(mean, expected[k], 4.9 * sigma);
  }
  double first_only = 0.0;
  for (const PlateShares& s : {at.s, at.p}) first_only += s.transmitted;
  const double mean = sum[1] / n, sigma = std::sqrt((square[1] / n - mean * mean) / n);
  EXPECT_GT(std::abs(mean - first_only), 20.0 * sigma);
}

// Over a grid of u and v: each side asked for alone has its share and its ways through the glass.
TEST(CoverGlass, OneSideAloneIsThatSideOfBoth) {
  const CoverGlassView cover_glass{true, 5000.0, 5000.0, 4.0, 2.5, 0.02};
  const Ray ray = ray_down(50.0, {0.0, 0.0, 4.0});
  const CoverGlassEntry entry = cover_glass_entry(cover_glass, {0, 0, 5.0}, ray.direction.vec());
  constexpr int kSteps = 500;
  double both[2] = {0.0, 0.0}, alone[2] = {0.0, 0.0}, share[2] = {0.0, 0.0};
  for (int i = 0; i < kSteps * kSteps; ++i) {
    const double u = (i % kSteps + 0.5) / kSteps, v = (i / kSteps + 0.5) / kSteps;
    const auto pass = [&](GlassSides sides) {
      return pass_cover_glass(cover_glass, {0, 0, 5.0}, ray.direction.vec(), entry, sides, u, v);
    };
    const CoverGlassOutcome out = pass(GlassSides::both);
    both[out.transmitted ? 1 : 0] += out.throughput * out.ways;
    for (const GlassSides side : {GlassSides::reflected, GlassSides::transmitted}) {
      const CoverGlassOutcome one = pass(side);
      const std::size_t k = side == GlassSides::transmitted ? 1 : 0;
      ASSERT_EQ(one.transmitted, k == 1);
      alone[k] += one.throughput * one.ways;
      share[k] = one.throughput;
    }
  }
  EXPECT_NEAR(
      share[0] + share[1],
      pass_cover_glass(cover_glass, {0, 0, 5.0}, ray.direction.vec(), entry, GlassSides::both, 0.5, 0.5)
          .throughput,
      1e-15);
  for (const int k : {0, 1}) EXPECT_NEAR(alone[k] / both[k], 1.0, 0.01);
}

TEST(CoverGlass, RimIsBlackAndStartsInsideAreFree) {
  const GlassTracer glass({clear()});
  const auto side = glass.first_hit({{60.0, 0.0, 2.0}, Direction::from({-1.0, 0.0, 0.0})}, 1e9, false);
  ASSERT_TRUE(side);
  EXPECT_NEAR(side->t_mm, 10.0, 1e-12);
  EXPECT_TRUE(side->edge);
  EXPECT_EQ(glass.pass({{60.0, 0.0, 2.0}, Direction::from({-1.0, 0.0, 0.0})}, *side, {}, 0.0F).throughput,
            0.0);
  EXPECT_FALSE(glass.first_hit({{0.0, 0.0, 2.0}, Direction::from({0.1, 0.0, 1.0})}, 1e9, false));
  EXPECT_FALSE(glass.first_hit({{0.0, 0.0, 4.0}, Direction::from({0.1, 0.0, 1.0})}, 1e9, false))
      << "leaves a face";
  EXPECT_FALSE(glass.first_hit({{51.0, 0.0, 9.0}, Direction::from({0.0, 0.0, -1.0})}, 1e9, false));
  // In through the face near the rim, out through the rim.
  const Ray steep = ray_down(80.0, {49.5, 0.0, 4.0});
  const auto hit = glass.first_hit({steep.at(-1.0), steep.direction}, 1e9, false);
  ASSERT_TRUE(hit);
  int throughput = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const GlassPassage p = glass.pass({steep.at(-1.0), steep.direction}, *hit, {1, i, 0}, 0.0F);
    EXPECT_FALSE(p.throughput > 0.0 && p.transmitted);
    throughput += p.throughput > 0.0;
  }
  EXPECT_GT(throughput, 20) << "reflected outside";
}

TEST(CoverGlass, RectanglesHaveCorners) {
  CoverGlass box = clear();
  box.aperture = Aperture::rectangle(20.0, 10.0);
  const GlassTracer glass({box});
  const Direction down = Direction::from({0.0, 0.0, -1.0});
  EXPECT_TRUE(glass.first_hit({{9.9, -4.9, 9.0}, down}, 1e9, false));
  EXPECT_FALSE(glass.first_hit({{9.9, -5.1, 9.0}, down}, 1e9, false));
  EXPECT_FALSE(glass.first_hit({{9.9, -4.9, 9.0}, down}, 4.9, false)) << "beyond the distance asked for";
}

TEST(CoverGlass, RefusesBadNumbers) {
  CoverGlass g = clear();
  g.refractive_index = 0.9;
  EXPECT_THROW(check(g), InputError);
  g = clear();
  g.thickness_mm = 0.0;
  EXPECT_THROW(check(g), InputError);
  g = clear();
  g.absorption_per_mm = -1.0;
  EXPECT_THROW(check(g), InputError);
  g = clear();
  g.aperture = Aperture::circle(10.0, 1.0);
  EXPECT_THROW(check(g), InputError);
}

/// `n` rays straight down from z = 50, over a disk of radius 5.
PlacedSource beam(std::size_t n) {
  auto set = std::make_shared<RaySet>();
  set->header.set_flux(1.0);
  set->rays.resize(n, 0);
  for (std::size_t i = 0; i < n; ++i) {
    Rng rng(3, i);
    const double r = 5.0 * std::sqrt(rng.uniform()), phi = 2.0 * std::numbers::pi * rng.uniform();
    set->rays.set(i, {{r * std::cos(phi), r * std::sin(phi), 50.0}, Direction::from({0.0, 0.0, -1.0})});
    set->rays.weight[i] = 1.0F;
  }
  return {std::make_shared<RaySetSource>(set, "beam"), Frame(), std::nullopt};
}

// A plane mirror of reflectance m under a plate: R + T^2 m / (1 - R m) goes back, each engine, to 4.9 sigma
// (1e-6). Being let through is no reflection: the light that only passes the plate leaves as direct light.
TEST(CoverGlassStatistical, PlateOverAMirror) {
  CoverGlass glass = clear(2.0);
  glass.absorption_per_mm = 0.03;
  glass.world_from_glass = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 20});
  const GlassShares s = glass_shares(glass, 1.0);
  const double m = 0.8, n = 100000.0;
  const Reflector plane = profile_reflector({{0.0, 0.0}, {50.0, 0.0}}, Aperture::circle(100.0));
  for (const EngineKind engine : {EngineKind::reference, EngineKind::fast}) {
    Scene scene{{beam(100000)}, {{plane, Frame(), Reflectance(m)}}, {{"far", 5.0, 1.0}}};
    scene.glasses = {glass};
    const TraceResult result = trace(scene, {.engine = engine, .cells = 64});
    const Ledger l = ledger(result);
    const double back = s.reflected + s.transmitted * s.transmitted * m / (1.0 - s.reflected * m);
    const double sigma = 0.5 / std::sqrt(n);
    EXPECT_NEAR(l.out_reflected.mean, back, 4.9 * sigma);
    EXPECT_EQ(l.out_direct.mean, 0.0);
    EXPECT_EQ(l.absorbed[2].first, "glass");
    EXPECT_GT(l.absorbed[2].second.mean, 0.1);
    for (const Tally& t : result.replicates) {
      EXPECT_EQ(t.emitted, t.out_direct + t.out_reflected + t.absorbed[0] + t.absorbed[1] + t.absorbed[2] +
                               t.lost[0] + t.lost[1]);
    }
    scene.reflectors.clear();
    const Ledger alone = ledger(trace(scene, {.max_bounces = 1, .engine = engine}));
    EXPECT_NEAR(alone.out_direct.mean, s.transmitted, 4.9 * sigma);
    EXPECT_NEAR(alone.out_reflected.mean, s.reflected, 4.9 * sigma);
    EXPECT_EQ(alone.lost_rays, 0u);
  }
}

// Both engines draw the same numbers: what they count differs by rounding alone.
TEST(CoverGlass, EnginesAgree) {
  Scene scene;
  scene.sources = {{make_emitter({.kind = EmitterKind::cylinder}), Frame(), std::nullopt}};
  scene.sources[0].world_from_source = Frame::from_axis(Direction{}, 0.0, {0, 0, 15});
  scene.reflectors = {{conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0)), Frame(),
                       Reflectance(0.9)}};
  CoverGlass glass = clear(1.52);
  glass.absorption_per_mm = 0.01;
  glass.world_from_glass = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 45});
  scene.glasses = {glass};
  scene.far_fields = {{"far", 5.0, 1.0}};
  const Ledger a = ledger(trace(scene, {.last_ray = 60000, .engine = EngineKind::reference}));
  const Ledger b = ledger(trace(scene, {.last_ray = 60000, .engine = EngineKind::fast}));
  const double e = 1e-4 * a.emitted;
  EXPECT_NEAR(a.out_direct.mean, b.out_direct.mean, e);
  EXPECT_NEAR(a.out_reflected.mean, b.out_reflected.mean, e);
  EXPECT_NEAR(a.absorbed[2].second.mean, b.absorbed[2].second.mean, e);
  EXPECT_GT(a.absorbed[2].second.mean, 0.01 * a.emitted);
  EXPECT_EQ(a.lost_rays + b.lost_rays, 0u);
}

}  // namespace
}  // namespace lucerna
