// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/design/shape/design_shape.h"
#include "lucerna/design/validation/mesh_hits.h"
#include "lucerna/source.h"
#include "lucerna/trace.h"
#include "lucerna/trace/tally/flux_quanta.h"
#include "tests/support/one_at_a_time.h"

namespace lucerna {
namespace {

constexpr double kHeight = 12.0;

/// A disk of light that shines up into a deep free form with a hole, which throws it down.
Scene bumpy_scene(double bump_mm = 1.0) {
  EmitterOptions emitter;
  emitter.kind = EmitterKind::disk;
  Scene s;
  s.sources.push_back({make_emitter(emitter), Frame(), {}});
  DesignShape shape = DesignShape::bspline(12.0, Aperture::circle(60.0, 6.0), 6, 6);
  shape = shape.through([&](double x, double y) {
    return (x * x + y * y) / 48.0 + bump_mm * std::sin(0.2 * x) * std::cos(0.15 * y + 0.3);
  });
  s.reflectors.push_back({shape.reflector(),
                          Frame::from_axis(Direction::from_unit({0, 0, -1}), 0.0, {0, 0, kHeight}),
                          Reflectance(0.8)});
  return s;
}

ErrorBoxes boxes() {
  return ErrorBoxes({Frame({1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {}), false, -0.6, 0.5, -0.5, 0.6});
}

std::vector<double> lambert(const ErrorBoxes& b) {
  return b.flux_of([](const Direction& d) { return std::max(0.0, -d.z()); }, 0.1);
}

ValidationOptions rays(std::uint64_t n, std::uint64_t seed = 1) {
  ValidationOptions o;
  o.seed = seed;
  o.min_rays = o.max_rays = n;
  o.tolerance = CadTolerance{.slope_deg = 1.0};  // a quick mesh, where only the way counts
  return o;
}

/// The light of the library's own tracer (double, exact surfaces) by replicate, in the same cells.
std::vector<BoxSums> traced(Scene s, const ErrorBoxes& b, std::uint64_t n) {
  s.ray_detectors.emplace_back();
  TraceOptions options;
  options.engine = EngineKind::reference;
  options.last_ray = n;
  options.seed = 99;
  const TraceResult result = trace(s, options);
  std::vector<BoxSums> sums(kReplicates);
  for (BoxSums& r : sums) {
    r.flux.assign(b.size(), 0.0);
    r.emitted = static_cast<double>(n / kReplicates);
    r.rays = n / kReplicates;
  }
  std::size_t at = 0;
  for (const OutRun& run : result.out_runs) {
    BoxSums& r = sums[run.block % kReplicates];
    for (std::uint32_t k = 0; k < run.rays; ++k, ++at) {
      const double flux = static_cast<double>(result.out_rays.weight[at]);
      const Direction d = result.out_rays.direction(at);
      r.flux[b.cell(result.out_rays.origin_mm(at), d)] += flux;
      r.out_reflected += flux;
    }
  }
  return sums;
}

TEST(ValidationStatistical, SeesTheLightOfTheLibrarysOwnTracer) {
  const ErrorBoxes b = boxes();
  constexpr std::uint64_t kRays = 1 << 20;
  ValidationOptions fine = rays(kRays);
  fine.tolerance = kOpticalTolerance;
  const Validation v = validate(bumpy_scene(), b, lambert(b), TargetMode::shape, fine);
  const auto own = traced(bumpy_scene(), b, kRays);
  // The tracer's mean as target: what is left is the noise of both. |v - own|^2 less both noises has a
  // relative scatter of sqrt(2 / cells); half as much more is granted, as errors of a net in neighbours hang
  // together. False alarm 1e-6.
  std::vector<double> target(b.size(), 0.0);
  for (const BoxSums& r : own) {
    for (std::size_t c = 0; c < b.size(); ++c) target[c] += r.flux[c] / r.emitted / kReplicates;
  }
  const DesignError difference = box_error(b, target, v.replicates, TargetMode::absolute);
  const DesignError noise = box_error(b, target, own, TargetMode::absolute);
  const auto close = [](const BoxErrorEstimate& d, const BoxErrorEstimate& f, double cells) {
    const double square = d.floor * d.floor + f.floor * f.floor;
    EXPECT_LT(std::abs(d.value * d.value - square), 5.0 * square * 1.5 * std::sqrt(2.0 / cells)) << cells;
  };
  close(difference.c12, noise.c12, 144.0);
  close(difference.c24, noise.c24, 576.0);
  close(difference.c48, noise.c48, 2304.0);
  const double sigma = std::hypot(difference.in_rectangle.standard_error, noise.in_rectangle.standard_error);
  EXPECT_NEAR(difference.in_rectangle.mean, noise.in_rectangle.mean, 5.0 * sigma);
  EXPECT_GT(difference.in_rectangle.mean, 0.3);
}

TEST(ValidationStatistical, FindsAMirrorThatIsNotTheOneThatWasAskedFor) {
  const ErrorBoxes b = boxes();
  constexpr std::uint64_t kRays = 1 << 19;
  std::vector<double> target(b.size(), 0.0);
  for (const BoxSums& r : traced(bumpy_scene(), b, kRays)) {
    for (std::size_t c = 0; c < b.size(); ++c) target[c] += r.flux[c] / r.emitted / kReplicates;
  }
  const Validation v = validate(bumpy_scene(1.1), b, target, TargetMode::shape, rays(kRays));
  EXPECT_GT(v.error.c12.excess, 0.02);
  EXPECT_GT(v.error.c12.excess, 5.0 * v.error.c12.standard_error);
}

TEST(Validation, LosesNoLight) {
  const ErrorBoxes b = boxes();
  const Validation v = validate(bumpy_scene(), b, lambert(b), TargetMode::shape, rays(1 << 17));
  EXPECT_NEAR(v.efficiency.mean + v.absorbed.mean + v.back.mean + v.bodies.mean + v.lost.mean, 1.0, 1e-9);
  EXPECT_NEAR(v.error.in_rectangle.mean + v.error.outside_share.mean, v.efficiency.mean, 1e-9);
  EXPECT_LE(v.error.outside_direct.mean, v.error.outside_share.mean);
  EXPECT_GT(v.error.outside_direct.mean, 0.0);  // through the hole, and past the rim
  EXPECT_GT(v.absorbed.mean, 0.1);
  EXPECT_EQ(v.back.mean, 0.0);
  EXPECT_EQ(v.rays, 1u << 17);
  EXPECT_GT(v.triangles, 1000u);
}

TEST(Validation, StopsWhereALargeErrorIsKnown) {
  const ErrorBoxes b = boxes();
  ValidationOptions o = rays(1 << 23);
  o.max_rays = 1 << 24;
  const Validation far = validate(bumpy_scene(), b, lambert(b), TargetMode::shape, o);
  EXPECT_LT(far.rays, o.min_rays);
  EXPECT_GE(far.rays, 1u << 20);
  EXPECT_LE(far.error.c48.standard_error, 0.01 * far.error.c48.excess);
  // Its own light as target: nothing but noise is left, and all rays are traced.
  std::vector<double> own(b.size(), 0.0);
  for (const BoxSums& r : far.replicates) {
    for (std::size_t c = 0; c < b.size(); ++c) own[c] += r.flux[c] / r.emitted / kReplicates;
  }
  o.min_rays = 1 << 21;
  o.max_rays = 1 << 22;
  o.seed = 5;
  EXPECT_EQ(validate(bumpy_scene(), b, own, TargetMode::shape, o).rays, o.max_rays);
}

TEST(Validation, OwnTreeAndEmbreeAgree) {
  if (!has_embree()) GTEST_SKIP() << "built without Embree";
  const ErrorBoxes b = boxes();
  ValidationOptions options = rays(1 << 16);
  options.tolerance = CadTolerance{.slope_deg = 1.0};
  options.engine = HitEngine::embree;
  const Validation a = validate(bumpy_scene(), b, lambert(b), TargetMode::shape, options);
  options.engine = HitEngine::tree;
  const Validation t = validate(bumpy_scene(), b, lambert(b), TargetMode::shape, options);
  EXPECT_TRUE(a.embree);
  EXPECT_FALSE(t.embree);
  // The same rays: only those that pass an edge within rounding may differ.
  EXPECT_NEAR(a.error.c48.value, t.error.c48.value, 2e-3);
  EXPECT_NEAR(a.efficiency.mean, t.efficiency.mean, 1e-4);
  EXPECT_NEAR(a.error.in_rectangle.mean, t.error.in_rectangle.mean, 1e-4);
}

TEST(Validation, TellsProgressOneAtATime) {
  const ErrorBoxes b = boxes();
  test::OneAtATime watch;
  const ThreadLimit limit(4);
  validate(bumpy_scene(), b, lambert(b), TargetMode::shape, rays(1 << 20), watch);
  EXPECT_GE(watch.calls, 16);
  EXPECT_EQ(watch.overlaps, 0);
  EXPECT_EQ(watch.falls, 0);
}

TEST(Validation, IsTheSameForAnyNumberOfThreads) {
  const ErrorBoxes b = boxes();
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return validate(bumpy_scene(), b, lambert(b), TargetMode::shape, rays(1 << 16));
  };
  const Validation one = run(1), three = run(3);
  EXPECT_EQ(one.error.c48.value, three.error.c48.value);
  EXPECT_EQ(one.error.outside.value, three.error.outside.value);
  for (std::size_t r = 0; r < one.replicates.size(); ++r) {
    EXPECT_EQ(one.replicates[r].flux, three.replicates[r].flux);
  }
}

TEST(ValidationStatistical, DirectLightOfALambertianSourceHasItsIntensity) {
  // Turned away from the mirror, the disk's light is the target exactly.
  Scene s = bumpy_scene();
  s.sources[0].world_from_source = Frame::from_axis(Direction::from_unit({0, 0, -1}), 0.0, {0, 0, -20});
  const ErrorBoxes b = boxes();
  const Validation v = validate(s, b, lambert(b), TargetMode::shape, rays(1 << 20));
  EXPECT_LT(v.error.c12.excess, 4.0 * v.error.c12.standard_error);
  EXPECT_LT(v.error.c48.excess, 4.0 * v.error.c48.standard_error);
  EXPECT_LT(v.error.c12.value, 0.01);
  EXPECT_EQ(v.efficiency.mean, 1.0);
  // Direction cosines are uniform over the disc.
  EXPECT_NEAR(v.error.in_rectangle.mean, 1.1 * 1.1 / std::numbers::pi, 1e-4);
}

TEST(Validation, BodiesShadeAndSlopeErrorsSpread) {
  const ErrorBoxes b = boxes();
  const Validation plain = validate(bumpy_scene(), b, lambert(b), TargetMode::shape, rays(1 << 16));
  Scene shaded = bumpy_scene();
  auto mesh = std::make_shared<Mesh>();
  mesh->vertices_mm = {{-5, -5, -3}, {5, -5, -3}, {5, 5, -3}, {-5, 5, -3}};
  mesh->triangles = {{0, 1, 2}, {0, 2, 3}};
  Body body;
  body.mesh = mesh;
  shaded.bodies.push_back(body);
  const Validation v = validate(shaded, b, lambert(b), TargetMode::shape, rays(1 << 16));
  EXPECT_GT(v.bodies.mean, 0.01);
  EXPECT_NEAR(v.efficiency.mean + v.absorbed.mean + v.back.mean + v.bodies.mean + v.lost.mean, 1.0, 1e-9);
  shaded.bodies[0].only_returning_light = true;
  shaded.bodies[0].reflectance = Reflectance(1.0);
  EXPECT_EQ(validate(shaded, b, lambert(b), TargetMode::shape, rays(1 << 14)).bodies.mean, 0.0);
  Scene rough = bumpy_scene();
  rough.reflectors[0].slope_error_mrad = 50.0;
  const Validation spread = validate(rough, b, lambert(b), TargetMode::shape, rays(1 << 16));
  EXPECT_NE(spread.error.c12.value, plain.error.c12.value);
}

TEST(Validation, RefusesScenesThatItCannotTrace) {
  const ErrorBoxes b = boxes();
  Scene none = bumpy_scene();
  none.sources.clear();
  EXPECT_THROW(validate(none, b, lambert(b), TargetMode::shape, rays(1 << 14)), InputError);
  Scene glass = bumpy_scene();
  glass.glasses.emplace_back();
  EXPECT_THROW(validate(glass, b, lambert(b), TargetMode::shape, rays(1 << 14)), InputError);
}

}  // namespace
}  // namespace lucerna
