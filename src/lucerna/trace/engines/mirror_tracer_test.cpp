// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/mirror_tracer.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "lucerna/optics/shapes/smooth_shape.h"
#include "lucerna/random.h"
#include "tests/support/random_direction.h"

namespace lucerna {
namespace {

using test::random_direction;

std::vector<double> random_heights(std::size_t n, double mm, std::uint64_t seed) {
  std::vector<double> out(n);
  Rng rng(seed, 0);
  for (double& z : out) z = mm * (2.0 * rng.uniform() - 1.0);
  return out;
}

Reflector free_form(double focal_mm, int intervals, double mm, const Aperture& aperture) {
  const KnotRow row{-30.0, 60.0 / intervals, intervals};
  const auto n = static_cast<std::size_t>(row.coefficients());
  return {std::make_shared<const SmoothSurface<BsplineShape>>(
              BsplineShape(focal_mm, row, row, random_heights(n * n, mm, 3))),
          aperture};
}

Reflector revolved(double focal_mm, int intervals, double mm, const Aperture& aperture) {
  const KnotRow row{0.0, 30.0 / intervals, intervals};
  std::vector<double> heights = random_heights(static_cast<std::size_t>(row.coefficients()), mm, 4);
  heights[0] = heights[2];
  return {std::make_shared<const SmoothSurface<RevolutionShape>>(RevolutionShape(focal_mm, row, heights)),
          aperture};
}

struct NamedMirror {
  std::string name;
  Reflector mirror;
};

/// The last has no base paraboloid, as the face of a lens.
std::vector<NamedMirror> smooth_mirrors() {
  constexpr double kNoBase = std::numeric_limits<double>::infinity();
  const Aperture ring = Aperture::circle(60.0, 8.0), disk = Aperture::circle(60.0);
  return {{"free form", free_form(12.0, 9, 0.5, ring)},
          {"of revolution", revolved(12.0, 10, 0.3, disk)},
          {"face", free_form(kNoBase, 24, 0.4, disk)},
          {"plane face", free_form(kNoBase, 4, 0.0, disk)}};
}

Ray random_ray(Rng& rng) {
  const Vec3 o{80.0 * rng.uniform() - 40.0, 80.0 * rng.uniform() - 40.0, 60.0 * rng.uniform() - 20.0};
  return {o, random_direction(rng)};
}

TEST(MirrorTracer, FindsTheHitsOfTheReferenceTracer) {
  for (const auto& [name, mirror] : smooth_mirrors()) {
    const ReferenceTracer reference(mirror);
    const MirrorTracer tracer(mirror);
    Rng rng(1, 0);
    int hits = 0, backs = 0, differing = 0;
    for (int i = 0; i < 20000; ++i) {
      const Ray ray = random_ray(rng);
      const auto expected = reference.first_hit(ray), found = tracer.first_hit(ray);
      const auto found_mm = tracer.first_mm(ray);
      ASSERT_EQ(found.has_value(), found_mm.has_value()) << name << i;
      hits += expected ? 1 : 0;
      backs += expected && !expected->front ? 1 : 0;
      if (found.has_value() != expected.has_value() ||
          (found && std::abs(found->t_mm - expected->t_mm) > 1e-8)) {
        ++differing;
        continue;
      }
      if (!found) continue;
      EXPECT_EQ(*found_mm, found->t_mm);
      EXPECT_EQ(found->front, expected->front) << name << i;
      EXPECT_LT(length(found->point_mm - expected->point_mm), 1e-8);
      EXPECT_LT(angle_between(found->normal, expected->normal), 1e-7);
    }
    EXPECT_GT(hits, 2000) << name;
    EXPECT_GT(backs, 500) << name;
    // The reference misses what grazes the surface twice within one of its cells.
    EXPECT_LE(differing, 4) << name;
  }
}

TEST(MirrorTracer, WhatLeavesASurfaceDoesNotMeetItsStart) {
  for (const auto& [name, mirror] : smooth_mirrors()) {
    const MirrorTracer tracer(mirror);
    Rng rng(2, 0);
    int leaving = 0;
    for (int i = 0; i < 20000; ++i) {
      const auto hit = tracer.first_hit(random_ray(rng));
      if (!hit) continue;
      const double side = hit->front ? 1.0 : -1.0;
      const Direction up = Direction::from({1e-9, 0.0, side});
      const auto again = tracer.first_mm({hit->point_mm, up});
      EXPECT_TRUE(!again || *again > 1e-3) << name << *again;
      ++leaving;
    }
    EXPECT_GT(leaving, 2000) << name;
  }
}

TEST(MirrorTracer, OtherSurfacesAreTracedByTheReference) {
  const Reflector conic = conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0));
  const auto hit = MirrorTracer(conic).first_hit({{3.0, 0.0, 50.0}, Direction::from({0.0, 0.0, -1.0})});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->t_mm, 50.0 - 9.0 / 60.0, 1e-12);
}

}  // namespace
}  // namespace lucerna
