// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/solid_tracer.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>

#include "lucerna/core/io/error.h"
#include "lucerna/material.h"
#include "lucerna/random.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/engines/ray_paths.h"
#include "tests/support/random_rays.h"

namespace lucerna {
namespace {

using Outline = std::vector<std::array<double, 2>>;

Solid turned(const Outline& outline, double index = 1.5) {
  Solid s;
  s.outline_mm = outline;
  s.refractive_index = index;
  return s;
}

/// A round plate between z = 0 and `thickness`.
Solid plate(double thickness, double index = 1.5) {
  return turned({{0.0, 0.0}, {50.0, 0.0}, {50.0, thickness}, {0.0, thickness}}, index);
}

Outline ball_outline(double radius, int steps) {
  Outline out;
  for (int i = 0; i <= steps; ++i) {
    const double a = std::numbers::pi * (static_cast<double>(i) / steps - 0.5);
    out.push_back({i == 0 || i == steps ? 0.0 : radius * std::cos(a), radius * std::sin(a)});
  }
  return out;
}

Ray ray_up(double angle_deg, const Vec3& from) {
  return {from, Direction::from({std::sin(radians(angle_deg)), 0.0, std::cos(radians(angle_deg))})};
}

/// A solid and a cosine disk of 2 mm below it, which shines up.
Scene scene_with(const Solid& solid, double disk_z_mm) {
  EmitterOptions options;
  options.kind = EmitterKind::disk;
  options.radius_mm = 1.0;
  Scene scene;
  scene.sources = {{make_emitter(options), Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, disk_z_mm}), {}}};
  scene.far_fields.emplace_back();
  scene.solids = {solid};
  return scene;
}

TraceResult traced(const Scene& scene, EngineKind engine, std::uint64_t rays) {
  TraceOptions options;
  options.last_ray = rays;
  options.engine = engine;
  return trace(scene, options);
}

TEST(Boundary, AgreesWithFresnelAtAThousandAngles) {
  for (const double n : {1.1, 1.49, 2.4}) {
    for (int i = 1; i <= 1000; ++i) {
      const double cosine = i / 1000.0;
      EXPECT_NEAR(boundary(n, cosine).reflectance(), fresnel_reflectance(cosine, {n, 0.0}), 1e-13)
          << n << ' ' << i;
    }
  }
}

// Stokes: at one boundary both sides reflect the same share, at angles that Snell's law pairs.
TEST(Boundary, ReflectsTheSameFromBothSides) {
  for (double cosine = 0.01; cosine <= 1.0; cosine += 0.01) {
    const Boundary in = boundary(1.6, cosine);
    const Boundary out = boundary(1.0 / 1.6, in.cos_refracted);
    EXPECT_NEAR(in.reflectance(), out.reflectance(), 1e-13);
    EXPECT_NEAR(out.cos_refracted, cosine, 1e-12);
  }
}

TEST(Boundary, IsTotalBeyondTheCriticalAngle) {
  const double critical = std::asin(1.0 / 1.5);
  EXPECT_LT(boundary(1.0 / 1.5, std::cos(critical - 1e-4)).reflectance(), 1.0);
  EXPECT_EQ(boundary(1.0 / 1.5, std::cos(critical + 1e-4)).reflectance(), 1.0);
  EXPECT_EQ(boundary(1.0, 0.3).reflectance(), 0.0);
}

TEST(Boundary, RefractsByVectorsAsSnellSays) {
  Rng rng(3, 0);
  for (int i = 0; i < 1000; ++i) {
    const Direction n = Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() + 0.1});
    Direction d = Direction::from({rng.uniform() - 0.5, rng.uniform() - 0.5, rng.uniform() - 0.5});
    if (dot(d, n) > 0.0) d = -d;
    const Vec3 out = refracted(d, n, 1.7, boundary(1.7, -dot(d, n)));
    EXPECT_NEAR(length(out), 1.0, 1e-12);
    EXPECT_NEAR(1.7 * length(cross(out, n.vec())), length(cross(d.vec(), n.vec())), 1e-12);
    EXPECT_NEAR(dot(out, cross(d.vec(), n.vec())), 0.0, 1e-12) << "in the plane of incidence";
  }
}

// A plate of triangles, followed through its inside, against the closed sum of a cover glass. 1e-6 false
// alarms at 4.9 sigma; what forgets its polarisation at each boundary is 0.04 off at 70
// degrees, 30 sigma.
TEST(SolidTracerStatistical, APlateLetsThroughWhatACoverGlassDoes) {
  CoverGlass glass;
  glass.thickness_mm = 4.0;
  glass.refractive_index = 2.0;
  glass.absorption_per_mm = 0.05;
  Solid solid = plate(4.0, 2.0);
  solid.absorption_per_mm = 0.05;
  const SolidTracer tracer({solid});
  const int n = 100000;
  for (const double angle : {0.0, 40.0, 70.0}) {
    const Ray ray = ray_up(angle, {0.0, 0.0, -1.0});
    const auto hit = tracer.first_hit(ray, 1e9, false);
    ASSERT_TRUE(hit);
    double sum[2] = {0.0, 0.0}, square[2] = {0.0, 0.0};
    for (int i = 0; i < n; ++i) {
      const GlassPassage p = tracer.pass(ray, *hit, {7, static_cast<std::uint64_t>(i), 0}, 0.0F);
      ASSERT_FALSE(p.lost);
      const int side = p.ray.direction.z() > 0.0 ? 1 : 0;
      EXPECT_NEAR(std::abs(p.ray.direction.z()), ray.direction.z(), 1e-9) << "parallel faces";
      sum[side] += p.throughput;
      square[side] += p.throughput * p.throughput;
    }
    const GlassShares shares = glass_shares(glass, std::cos(radians(angle)));
    for (const auto& [side, expected] : {std::pair{1, shares.transmitted}, {0, shares.reflected}}) {
      const double mean = sum[side] / n, sigma = std::sqrt((square[side] / n - mean * mean) / n);
      EXPECT_NEAR(mean, expected, 4.9 * sigma) << angle << ' ' << side;
    }
  }
}

// A prism of 30 degrees: light that enters at a right angle leaves at asin(n sin 30) from the other face.
TEST(SolidTracer, APrismBendsLightAsSnellSays) {
  Mesh mesh;
  const double h = 10.0 * std::tan(radians(30.0));
  mesh.vertices_mm = {{0, -5, 0}, {10, -5, 0}, {10, -5, h}, {0, 5, 0}, {10, 5, 0}, {10, 5, h}};
  mesh.triangles = {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {1, 4, 5}, {1, 5, 2}, {0, 2, 5}, {0, 5, 3}};
  Solid prism;
  prism.mesh = std::make_shared<const Mesh>(mesh);
  prism.refractive_index = 1.5;
  prism.smooth_below_deg = 0.0;
  const SolidTracer tracer({prism});
  const Ray ray = ray_up(0.0, {5.0, 0.3, -3.0});
  const auto hit = tracer.first_hit(ray, 1e9, false);
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t_mm, 3.0, 1e-6);
  int through = 0;
  for (std::uint64_t i = 0; i < 200; ++i) {
    const GlassPassage p = tracer.pass(ray, *hit, {1, i, 0}, 0.0F);
    if (!(p.ray.direction.z() > 0.0)) continue;
    ++through;
    // The face's normal leans to -x by 30 degrees; the ray leaves on its far side.
    const double expected = degrees(std::asin(1.5 * 0.5)) - 30.0;
    EXPECT_NEAR(degrees(std::atan2(p.ray.direction.x(), p.ray.direction.z())), expected, 1e-5);
  }
  EXPECT_GT(through, 150);
}

// A ball lens gathers parallel light near its paraxial focus n R / (2 (n - 1)) from its middle.
TEST(SolidTracer, ABallLensHasItsFocus) {
  const SolidTracer tracer({turned(ball_outline(10.0, 720), 1.5)});
  const double focus = 1.5 * 10.0 / (2.0 * 0.5);
  int seen = 0;
  for (std::uint64_t i = 0; i < 100; ++i) {
    const Ray ray = ray_up(0.0, {0.2, 0.1, -30.0});
    const auto hit = tracer.first_hit(ray, 1e9, false);
    ASSERT_TRUE(hit);
    const GlassPassage p = tracer.pass(ray, *hit, {5, i, 0}, 0.0F);
    if (!(p.ray.direction.z() > 0.9)) continue;
    ++seen;
    const Vec3& o = p.ray.origin_mm;
    const Vec3& d = p.ray.direction.vec();
    const double t = -(o.x * d.x + o.y * d.y) / (d.x * d.x + d.y * d.y);  // nearest to the axis
    EXPECT_NEAR(o.z + t * d.z, focus, 0.05);
  }
  EXPECT_GT(seen, 80);
}

// An ellipsoid of eccentricity 1 / n gathers parallel light at its far focus (R. Descartes, 1637), and a
// sphere about that focus lets it out as it comes.
TEST(SolidTracer, ACartesianOvalIsStigmatic) {
  const double n = 1.5, half_axis = 20.0, e = 1.0 / n, b = half_axis * std::sqrt(1.0 - e * e);
  const double focus = half_axis * e, back = 12.0;
  Outline outline;
  const int steps = 600;
  for (int i = 0; i <= steps; ++i) {
    const double a = radians(60.0) * i / steps;
    outline.push_back({b * std::sin(a), -half_axis * std::cos(a)});
  }
  const double side = std::asin(outline.back()[0] / 1.3 / back);
  for (int i = steps; i >= 0; --i) {
    const double a = side * i / steps;
    outline.push_back({back * std::sin(a), focus - back * std::cos(a)});
  }
  const SolidTracer tracer({turned(outline, n)});
  int through = 0, astray = 0;
  for (std::uint64_t i = 0; i < 1000; ++i) {
    Rng rng(4, i);
    const double r = 8.0 * std::sqrt(rng.uniform()), phi = radians(360.0 * rng.uniform());
    const Ray ray = ray_up(0.0, {r * std::cos(phi), r * std::sin(phi), -40.0});
    const auto hit = tracer.first_hit(ray, 1e9, false);
    ASSERT_TRUE(hit);
    const GlassPassage p = tracer.pass(ray, *hit, {6, i, 0}, 0.0F);
    if (!(p.ray.direction.z() > 0.5)) continue;
    const Vec3 to = Vec3{0.0, 0.0, focus} - p.ray.origin_mm;
    (length(cross(to, p.ray.direction.vec())) < 1e-6 ? through : astray) += 1;
  }
  EXPECT_GT(through, 850);
  EXPECT_LT(astray, 15) << "what was reflected to and fro within";
}

/// What makes light from the origin parallel: within `inner_mm` of the axis a surface of equal optical path
/// (a hyperbola), around it a wall that refracts and a side that reflects to +z, of equal optical path too.
Outline collimator(double n, double focus_mm, double inner_mm) {
  double low = 0.1, high = radians(40.0);
  const auto radius = [&](double angle) { return focus_mm * (n - 1.0) / (n * std::cos(angle) - 1.0); };
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (radius(middle) * std::sin(middle) > inner_mm ? high : low) = middle;
  }
  const int steps = 200;
  Outline out;
  for (int i = 0; i <= steps; ++i) {
    const double angle = low * i / steps;
    out.push_back({radius(angle) * std::sin(angle), radius(angle) * std::cos(angle)});
  }
  const double base = radians(88.0);
  // The path to the side and on to a plane above is the same for all angles from the axis.
  const auto on_wall = [&](double angle) { return inner_mm / std::tan(angle); };
  const double path = n * (1.0 - std::cos(base) / n) + inner_mm / std::sin(base) - n * on_wall(base);
  out.push_back({inner_mm, on_wall(base)});
  for (int i = 0; i <= steps; ++i) {
    const double angle = base + (low - base) * i / steps, up = std::cos(angle) / n;
    const double way = (path - inner_mm / std::sin(angle) + n * on_wall(angle)) / (n * (1.0 - up));
    out.push_back({inner_mm + way * std::sqrt(1.0 - up * up), on_wall(angle) + way * up});
  }
  const double rim = out.back()[0];
  out.push_back({rim, 18.0});
  out.push_back({0.0, 18.0});
  return out;
}

// Light from a point leaves parallel, through the lens and by way of the side that reflects it totally.
TEST(SolidTracer, ACollimatorOfEqualPathsSendsLightAlongItsAxis) {
  const SolidTracer tracer({turned(collimator(1.49, 6.0, 5.0), 1.49)});
  for (const double angle : {3.0, 12.0, 25.0, 35.0, 50.0, 65.0, 80.0}) {
    const Ray ray = {{0.0, 0.0, 0.0},
                     Direction::from({std::sin(radians(angle)), 0.01, std::cos(radians(angle))})};
    const auto hit = tracer.first_hit(ray, 1e9, false);
    ASSERT_TRUE(hit) << angle;
    int along = 0;
    for (std::uint64_t i = 0; i < 100; ++i) {
      const GlassPassage p = tracer.pass(ray, *hit, {9, i, 0}, 0.0F);
      along += p.ray.direction.z() > std::cos(radians(0.2)) ? 1 : 0;
    }
    EXPECT_GT(along, 80) << angle;
  }
}

// No medium but its own takes light: what is emitted leaves, to the last quantum, or is named.
TEST(SolidTracer, TheLedgerClosesAndAClearLensKeepsNothing) {
  for (const EngineKind engine : {EngineKind::fast, EngineKind::reference}) {
    const Ledger l = ledger(traced(scene_with(plate(5.0), -3.0), engine, 20000));
    EXPECT_NEAR(l.out_direct.mean + l.out_reflected.mean, l.emitted, 1e-9 * l.emitted);
    EXPECT_GT(l.out_reflected.mean, 0.02 * l.emitted);
    EXPECT_EQ(l.absorbed[2].second.mean, 0.0);
  }
}

// Light that starts in a medium of index n leaves a flat face within the critical angle only.
TEST(SolidTracer, LightFromInsideLeavesWithinTheCriticalCone) {
  Solid block = turned({{0.0, 0.0}, {2000.0, 0.0}, {2000.0, 10.0}, {0.0, 10.0}});
  const SolidTracer tracer({block});
  for (const double angle : {0.0, 20.0, 41.0, 43.0, 60.0}) {
    const Ray ray = ray_up(angle, {0.0, 0.0, 5.0});
    const auto hit = tracer.first_hit(ray, 1e9, false);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->t_mm, 5.0 / std::cos(radians(angle)), 1e-5);
    const GlassPassage p = tracer.pass(ray, *hit, {2, 3, 0}, 0.0F);
    const bool is_guided = angle > degrees(std::asin(1.0 / 1.5));
    // Beyond it the light goes to and fro until it comes to the rim, or is given up.
    if (is_guided) {
      EXPECT_TRUE(p.lost || std::abs(length({p.ray.origin_mm.x, p.ray.origin_mm.y, 0.0}) - 2000.0) < 1.0);
    } else {
      ASSERT_FALSE(p.lost);
      EXPECT_NEAR(std::sin(radians(angle)) * 1.5, p.ray.direction.x(), 1e-6);
    }
  }
}

// In the tracing of vectors and in that of single rays in double the same light leaves in the same
// directions.
TEST(SolidTracer, BothEnginesAgree) {
  Solid lens = turned({{0.0, 0.0}, {12.0, 0.0}, {12.0, 2.0}, {8.0, 5.0}, {0.0, 7.0}});
  lens.absorption_per_mm = 0.01;
  const Scene scene = scene_with(lens, -2.0);
  const Ledger a = ledger(traced(scene, EngineKind::fast, 40000));
  const Ledger b = ledger(traced(scene, EngineKind::reference, 40000));
  const double kept = b.absorbed[2].second.mean;
  EXPECT_NEAR(a.absorbed[2].second.mean, kept, 1e-3 * kept);
  EXPECT_NEAR(a.out_direct.mean, b.out_direct.mean, 1e-3 * b.out_direct.mean);
  EXPECT_GT(kept, 0.01 * a.emitted);
  EXPECT_NEAR(a.all_lost.mean, b.all_lost.mean, 1e-4 * a.emitted);
}

// Places between bodies are rounded to float, some 1e-5 mm in a wide body: what leaves it has left it. Light
// that meets its wall again at once is guided or refracted twice; 20 % of it was lost so.
TEST(SolidTracer, LightThatLeftAWideBodyIsOutOfIt) {
  for (const double radius_mm : {10.0, 100.0, 300.0}) {
    Solid disk = turned({{0.0, 0.0}, {radius_mm, 0.0}, {radius_mm, 2.0}, {0.0, 2.0}});
    EmitterOptions options;
    options.kind = EmitterKind::sphere;
    options.radius_mm = 0.2;
    Scene scene;
    const Frame at_rim({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {radius_mm - 0.5, 0.0, 1.0});
    scene.sources = {{make_emitter(options), at_rim, {}}};
    scene.far_fields.emplace_back();
    scene.solids = {disk};
    const Ledger a = ledger(traced(scene, EngineKind::fast, 40000));
    const Ledger b = ledger(traced(scene, EngineKind::reference, 40000));
    EXPECT_NEAR(a.all_lost.mean, b.all_lost.mean, 0.002 * a.emitted) << radius_mm;
    EXPECT_NEAR(a.reflections_per_ray.mean, b.reflections_per_ray.mean, 1e-3) << radius_mm;
  }
}

TEST(SolidTracer, ARayBetweenBodiesMeetsThemFromOutsideOnly) {
  const SolidTracer tracer({plate(5.0)});
  const Ray near = ray_up(20.0, {0.0, 0.0, -5e-4}), within = ray_up(20.0, {0.0, 0.0, 5.0 - 1e-5});
  const auto hit = tracer.first_hit(near, 1e9, true);
  ASSERT_TRUE(hit) << "another part of the body it left, as of fine lenslets";
  EXPECT_NEAR(hit->t_mm, 5e-4 / std::cos(radians(20.0)), 1e-9);
  EXPECT_FALSE(tracer.first_hit(within, 1e9, true)) << "it has left the body";
  EXPECT_TRUE(tracer.first_hit(within, 1e9, false)) << "it starts in the body";
}

TEST(SolidTracer, PathsHoldThePointsOnTheSurface) {
  const Scene scene = scene_with(plate(5.0), -3.0);
  int through = 0;
  for (const RayPath& p : ray_paths(scene, 50, {})) {
    for (std::size_t i = 1; i < p.points_mm.size(); ++i) {
      const double z = p.points_mm[i].z;
      EXPECT_TRUE(std::abs(z) < 1e-5 || std::abs(z - 5.0) < 1e-5 || (z > 0.0 && z < 5.0)) << z;
    }
    through += p.points_mm.size() == 3 && p.last_direction.z() > 0.0 ? 1 : 0;
  }
  EXPECT_GT(through, 30);
}

std::string complaint(const Scene& scene) {
  try {
    traced(scene, EngineKind::fast, 1000);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

TEST(SolidTracer, WhatIsNotApartIsRefusedByName) {
  Scene scene = scene_with(plate(5.0), -3.0);
  scene.solids.push_back(turned(ball_outline(2.0, 20)));
  scene.solids[1].name = "ball";
  const auto at = [&](double z) {
    scene.solids[1].world_from_solid = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, z});
    return complaint(scene);
  };
  EXPECT_EQ(at(20.0), "");
  const std::string refusal =
      "solid 'ball' and solid 'solid': one holds, cuts or touches the other; expected them apart";
  EXPECT_EQ(at(2.5), refusal) << "within";
  EXPECT_EQ(at(5.0), refusal) << "cuts";
  scene.solids[1].outline_mm = plate(3.0).outline_mm;
  EXPECT_EQ(at(5.0), refusal) << "touches";
  EXPECT_EQ(at(5.1), "");
}

/// The same body as triangles.
Solid as_triangles(Solid solid) {
  solid.mesh = surface_mesh(solid);
  solid.outline_mm.clear();
  return solid;
}

// One body as cones and as triangles, of which circles are 0.004 % smaller. 1e-6 false alarms at 4.9 sigma of
// 40000 rays, 0.3 % of what is emitted: a mesh without smooth normals sends 2 % elsewhere.
TEST(SolidTracerStatistical, AnOutlineAndItsMeshSendTheSameLight) {
  Solid lens = turned(collimator(1.49, 6.0, 5.0), 1.49);
  lens.absorption_per_mm = 0.02;
  const auto ledger_of = [](const Solid& s) {
    return ledger(traced(scene_with(s, 0.1), EngineKind::fast, 40000));
  };
  const Ledger a = ledger_of(lens), b = ledger_of(as_triangles(lens));
  EXPECT_NEAR(a.absorbed[2].second.mean, b.absorbed[2].second.mean, 0.003 * b.emitted);
  EXPECT_NEAR(a.out_direct.mean, b.out_direct.mean, 0.012 * b.emitted);
  EXPECT_EQ(a.all_lost.mean, 0.0);
}

TEST(SolidTracer, AMeshIsAsFineAsItsTolerance) {
  const Solid lens = turned(collimator(1.49, 6.0, 5.0), 1.49);
  const std::size_t coarse = surface_mesh(lens)->triangles.size();
  EXPECT_EQ(surface_mesh(lens, kSurfaceTolerance)->triangles.size(), coarse);
  EXPECT_GT(surface_mesh(lens, 0.01 * kSurfaceTolerance)->triangles.size(), coarse);
  for (const double wrong : {0.0, -1e-4, 2.0, std::nan("")}) {
    EXPECT_EQ(test::message_of<InputError>([&] { (void)surface_mesh(lens, wrong); }),
              fmt::format("tolerance of a mesh: found {}, expected 1e-8 to 1", wrong));
  }
}

TEST(SolidTracer, HasEitherAMeshOrAnOutline) {
  Solid both = plate(5.0), none = plate(5.0);
  both.mesh = surface_mesh(both);
  none.outline_mm.clear();
  const auto refusal_of = [](const Solid& s) { return test::message_of<InputError>([&] { check(s); }); };
  EXPECT_EQ(refusal_of(both), "solid 'solid' has both, expected either a mesh or an outline");
  EXPECT_EQ(refusal_of(none), "solid 'solid' has no surface, expected either a mesh or an outline");
}

TEST(SolidTracer, OpenAndTurnedSurfacesAreRefused) {
  Solid s = as_triangles(plate(5.0));
  Mesh open = *s.mesh, turned_one = *s.mesh;
  open.triangles.pop_back();
  std::swap(turned_one.triangles[5][0], turned_one.triangles[5][1]);
  s.mesh = std::make_shared<const Mesh>(open);
  EXPECT_THROW(check(s), InputError);
  s.mesh = std::make_shared<const Mesh>(turned_one);
  EXPECT_THROW(check(s), InputError);
  // All turned alike is a matter of taste.
  Mesh inside_out = *surface_mesh(plate(5.0));
  for (auto& t : inside_out.triangles) std::swap(t[0], t[1]);
  s.mesh = std::make_shared<const Mesh>(inside_out);
  const Ledger a = ledger(traced(scene_with(s, -3.0), EngineKind::fast, 5000));
  const Ledger b = ledger(traced(scene_with(plate(5.0), -3.0), EngineKind::fast, 5000));
  EXPECT_NEAR(a.out_direct.mean, b.out_direct.mean, 1e-3 * b.out_direct.mean);
}

}  // namespace
}  // namespace lucerna
