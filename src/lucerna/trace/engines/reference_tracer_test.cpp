// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/engines/reference_tracer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "lucerna/optics/shapes/spline_surface.h"
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

/// The same surface, of which nothing is said.
class OfUnknownShape final : public HeightSurface {
 public:
  explicit OfUnknownShape(std::shared_ptr<const HeightSurface> surface) : surface_(std::move(surface)) {}
  SurfacePoint at(double x_mm, double y_mm) const override { return surface_->at(x_mm, y_mm); }
  HeightRange range(const Rectangle& region) const override { return surface_->range(region); }

 private:
  std::shared_ptr<const HeightSurface> surface_;
};

/// A bowl with a bump of `bump_mm` beside its middle; convex all over if there is none.
SplineSurface bowl(double bump_mm) {
  std::vector<double> z;
  for (int j = 0; j < 12; ++j) {
    for (int i = 0; i < 12; ++i) {
      const double x = 80.0 * i / 11.0 - 40.0, y = 80.0 * j / 11.0 - 40.0;
      z.push_back((x * x + 1.3 * y * y) / 60.0 + bump_mm * std::exp(-std::hypot(x - 18.0, y - 9.0) / 6.0));
    }
  }
  return SplineSurface::through({-40.0, 40.0, -40.0, 40.0}, 12, 12, z);
}

TEST(ReferenceTracer, ConvexSurfacesAreHitWhereTheWholeTreeIsWalked) {
  const Aperture round = Aperture::circle(80.0, 12.0);
  const auto spline = [&](double bump_mm) {
    return Reflector{std::make_shared<SplineSurface>(bowl(bump_mm)), Aperture::rectangle(80.0, 70.0)};
  };
  const std::vector<std::pair<Reflector, bool>> mirrors{
      {conic_reflector(ConicPreset::ellipse, 15.0, 300.0, round), true},
      {conic_trough(ConicPreset::parabola, 12.0, 0.0, Aperture::rectangle(70.0, 90.0)), true},
      {profile_reflector({{0.0, 0.0}, {12.0, 2.0}, {25.0, 9.5}, {40.0, 26.0}}, round), true},
      {profile_reflector({{0.0, 0.0}, {12.0, 5.0}, {25.0, 9.5}, {40.0, 26.0}}, round), false},
      {spline(0.0), true},
      {spline(6.0), false}};
  for (const auto& [mirror, convex] : mirrors) {
    EXPECT_EQ(mirror.surface->convex_over(mirror.aperture.bounds()), convex);
    const ReferenceTracer tracer(mirror, 6);
    const ReferenceTracer whole({std::make_shared<OfUnknownShape>(mirror.surface), mirror.aperture}, 6);
    Rng rng(4, 0);
    int hits = 0;
    for (int i = 0; i < 10'000; ++i) {
      const Vec3 from{100.0 * rng.uniform() - 50.0, 100.0 * rng.uniform() - 50.0,
                      60.0 * rng.uniform() - 20.0};
      Ray ray{from, random_direction(rng)};
      // As light goes: from a lamp, then from the mirror.
      for (int bounce = 0; bounce < 3; ++bounce) {
        const auto hit = tracer.first_hit(ray), expected = whole.first_hit(ray);
        ASSERT_EQ(hit.has_value(), expected.has_value()) << i << ", bounce " << bounce;
        if (!hit) break;
        ++hits;
        ASSERT_NEAR(hit->t_mm, expected->t_mm, 1e-9);
        ASSERT_EQ(hit->front, expected->front);
        ray = {hit->point_mm, reflect(ray.direction, hit->normal)};
      }
    }
    EXPECT_GT(hits, 2000);
  }
}

}  // namespace
}  // namespace lucerna
