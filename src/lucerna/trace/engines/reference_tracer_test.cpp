// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/reference_tracer.h"

#include <gtest/gtest.h>

#include <cmath>

#include "lucerna/random.h"
#include "tests/support/random_direction.h"

namespace lucerna {
namespace {

using test::random_direction;

/// First crossing of a paraboloid z = r^2 / (4 f) inside the aperture, in closed form.
std::optional<double> paraboloid_hit(const Ray& ray, double f, const Aperture& aperture) {
  const Vec3 &o = ray.origin_mm, d = ray.direction.vec();
  const double a = d.x * d.x + d.y * d.y, b = 2.0 * (o.x * d.x + o.y * d.y) - 4.0 * f * d.z;
  const double c = o.x * o.x + o.y * o.y - 4.0 * f * o.z;
  const double q = b * b - 4.0 * a * c;
  if (q < 0.0) return std::nullopt;
  const double w = -0.5 * (b + std::copysign(std::sqrt(q), b));
  double t0 = w / a, t1 = c / w;
  if (t0 > t1) std::swap(t0, t1);
  for (const double t : {t0, t1}) {
    if (t >= 0.0 && aperture.contains(o.x + t * d.x, o.y + t * d.y)) return t;
  }
  return std::nullopt;
}

TEST(ReferenceTracer, MeetsTheParaboloidWhereTheFormulaSays) {
  const double f = 15.0;
  for (const Aperture& aperture : {Aperture::circle(100.0, 10.0), Aperture::rectangle(90.0, 60.0)}) {
    const ReferenceTracer tracer(conic_reflector(ConicPreset::parabola, f, 0.0, aperture), 6);
    Rng rng(1, 0);
    int hits = 0, backs = 0;
    for (int i = 0; i < 40000; ++i) {
      const Vec3 o{160.0 * rng.uniform() - 80.0, 160.0 * rng.uniform() - 80.0, 120.0 * rng.uniform() - 40.0};
      const Ray ray{o, random_direction(rng)};
      const auto expected = paraboloid_hit(ray, f, aperture);
      const auto hit = tracer.first_hit(ray);
      ASSERT_EQ(hit.has_value(), expected.has_value()) << i;
      if (!hit) continue;
      ++hits;
      backs += !hit->front;
      EXPECT_NEAR(hit->t_mm, *expected, 1e-9);
      const Direction normal =
          Direction::from({-hit->point_mm.x / (2.0 * f), -hit->point_mm.y / (2.0 * f), 1.0});
      EXPECT_LT(angle_between(hit->normal, normal), 1e-12);
      EXPECT_EQ(hit->front, dot(ray.direction, normal) < 0.0);
    }
    EXPECT_GT(hits, 2500);
    EXPECT_GT(backs, 1000);
  }
}

TEST(ReferenceTracer, RaysAlongTheAxisAndAlongGridLines) {
  const ReferenceTracer tracer(
      conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0, 8.0)), 8);
  const Direction down = Direction::from({0.0, 0.0, -1.0});
  for (int i = -48; i <= 48; ++i) {  // x on cell borders: the cells are 100 / 256 mm wide
    const double x = i * (100.0 / 256.0) * 2.0, y = 100.0 / 256.0 * 12.0;
    const auto hit = tracer.first_hit({{x, y, 90.0}, down});
    ASSERT_EQ(hit.has_value(), x * x + y * y <= 2500.0 && x * x + y * y >= 16.0) << x;
    if (hit) {
      EXPECT_NEAR(hit->t_mm, 90.0 - (x * x + y * y) / 60.0, 1e-12);
    }
  }
  EXPECT_FALSE(tracer.first_hit({{0.0, 0.0, 90.0}, down}));
  for (const double y : {0.0, 25.0 / 64.0}) {
    const auto along = tracer.first_hit({{0.0, y, 20.0}, Direction::from({1.0, 0.0, 0.0})});
    ASSERT_TRUE(along);
    EXPECT_NEAR(along->t_mm, std::sqrt(1200.0 - y * y), 1e-10);
  }
}

// A chord that dips below the surface and back within one cell of a coarse tree.
TEST(ReferenceTracer, FindsBothCrossingsInOneCell) {
  const Reflector r =
      profile_reflector({{10.0, 0.0}, {20.0, 5.0}, {30.0, 0.0}}, Aperture::circle(60.0, 20.0));
  const ReferenceTracer coarse(r, 1), fine(r, 8);
  const Ray ray{{12.0, 1.0, 4.9}, Direction::from({1.0, 0.0, 0.0})};
  const auto a = coarse.first_hit(ray), b = fine.first_hit(ray);
  ASSERT_TRUE(a && b);
  EXPECT_NEAR(a->t_mm, b->t_mm, 1e-11);
  EXPECT_TRUE(a->front);
}

// A ray that starts where it was just reflected leaves the mirror and does not meet its own start again.
TEST(ReferenceTracer, NoSelfHits) {
  const ReferenceTracer tracer(conic_reflector(ConicPreset::parabola, 15.0, 0.0, Aperture::circle(100.0)), 8);
  Rng rng(2, 0);
  int reflected = 0;
  for (int i = 0; i < 20000; ++i) {
    const auto hit = tracer.first_hit({{0.0, 0.0, 15.0}, random_direction(rng)});
    if (!hit) continue;
    ++reflected;
    const Direction up = Direction::from({1e-9 * (rng.uniform() - 0.5), 0.0, 1.0});
    EXPECT_FALSE(tracer.first_hit({hit->point_mm, up}));
    const auto chord = tracer.first_hit({hit->point_mm, reflect(random_direction(rng), hit->normal)});
    if (chord) {
      EXPECT_GT(chord->t_mm, 0.0);
    }
    if (chord) {
      EXPECT_TRUE(chord->front || chord->t_mm < 1e-6);
    }
  }
  EXPECT_GT(reflected, 5000);
}

}  // namespace
}  // namespace lucerna
