// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/curve_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>

#include "lucerna/geometry.h"
#include "lucerna/random.h"
#include "lucerna/trace/engines/reference_tracer.h"
#include "tests/support/random_direction.h"

namespace lucerna {
namespace {

using test::random_direction;

Vec3 random_point(Rng& rng, double half) {
  const double x = half * (2.0 * rng.uniform() - 1.0), y = half * (2.0 * rng.uniform() - 1.0);
  return {x, y, half * (2.0 * rng.uniform() - 1.0)};
}

/// Roots of a t^2 + 2 b t + c = 0 at t >= 0 that `there` takes, nearest first.
template <class There>
std::optional<double> first_root(double a, double b, double c, const There& there) {
  const double q = b * b - a * c;
  if (q < 0.0 || a == 0.0) return std::nullopt;
  for (const double root : {-std::sqrt(q), std::sqrt(q)}) {
    const double t = (-b + root) / a;
    if (t >= 0.0 && there(t)) return t;
  }
  return std::nullopt;
}

struct Counts {
  int hits = 0, backs = 0, differ = 0;
};

/// Hits of random rays against a formula for the distance; `normal` gives the inward normal at a point.
template <class Formula, class Normal>
Counts compare_to_formula(const Reflector& mirror, const Vec3& centre, double half, const Formula& formula,
                          const Normal& normal, double tolerance) {
  const ReferenceTracer tracer(mirror);
  Rng rng(1, 0);
  Counts c;
  for (int i = 0; i < 100000; ++i) {
    const Ray ray{centre + random_point(rng, half), random_direction(rng)};
    const std::optional<double> expected = formula(ray);
    const auto hit = tracer.first_hit(ray);
    if (hit.has_value() != expected.has_value()) {
      ++c.differ;
      continue;
    }
    if (!hit) continue;
    ++c.hits;
    c.backs += !hit->front;
    EXPECT_NEAR(hit->t_mm, *expected, tolerance);
    const Direction n = Direction::from(normal(ray.at(*expected)));
    EXPECT_LT(angle_between(hit->normal, n), 1e-6);
    EXPECT_EQ(hit->front, dot(ray.direction, n) < 0.0);
  }
  return c;
}

TEST(CurveKernel, SphereWithHoleAndMouth) {
  const double radius = 20.0, hole = 3.0, mouth = 8.0;
  const Reflector mirror = deep_ellipse_reflector(radius, radius, 2.0 * mouth, 2.0 * hole);
  const Counts c = compare_to_formula(
      mirror, {0, 0, radius}, 30.0,
      [&](const Ray& ray) {
        const Vec3 o = ray.origin_mm - Vec3{0, 0, radius};
        return first_root(1.0, dot(o, ray.direction), dot(o, o) - radius * radius, [&](double t) {
          const Vec3 p = ray.at(t);
          return std::hypot(p.x, p.y) >= (p.z < radius ? hole : mouth);
        });
      },
      [&](const Vec3& p) {
        return Vec3{0, 0, radius} - p;
      },
      1e-7);
  EXPECT_GT(c.hits, 25000);
  EXPECT_GT(c.backs, 5000);
  // Within the spline's 1e-9 of hole, mouth or of grazing.
  EXPECT_LE(c.differ, 1);
}

TEST(CurveKernel, TubeAndCone) {
  for (const double top : {10.0, 10.5, 60.0}) {
    const Reflector mirror =
        profile_reflector({{10.0, 0.0}, {top, 50.0}}, Aperture::circle(2.0 * top, top == 60.0 ? 20.0 : 0.0));
    ASSERT_EQ(mirror.curve == nullptr, top == 60.0);
    const double k = (top - 10.0) / 50.0;
    const Counts c = compare_to_formula(
        mirror, {0, 0, 25.0}, 40.0,
        [&](const Ray& ray) {
          const Vec3 o = ray.origin_mm, d = ray.direction.vec();
          const double r = 10.0 + k * o.z;
          return first_root(d.x * d.x + d.y * d.y - k * k * d.z * d.z, o.x * d.x + o.y * d.y - k * d.z * r,
                            o.x * o.x + o.y * o.y - r * r, [&](double t) {
                              const double z = o.z + t * d.z;
                              return z >= 0.0 && z <= 50.0;
                            });
        },
        [&](const Vec3& p) {
          return Vec3{-p.x, -p.y, k * std::hypot(p.x, p.y)};
        },
        1e-7);
    EXPECT_GT(c.hits, 5000);
    EXPECT_LE(c.differ, top == 60.0 ? 40 : 1) << "a cone that is a height field is traced as one";
  }
}

TEST(CurveKernel, RoundTroughPastItsEquator) {
  const double radius = 20.0;
  std::vector<ProfileKnot> knots;
  for (int i = 0; i <= 256; ++i) {
    const double a = radians(150.0) * i / 256;
    knots.push_back({radius * std::sin(a), radius * (1.0 - std::cos(a))});
  }
  const Reflector mirror = profile_trough(knots, Aperture::rectangle(2.0 * knots.back().r_mm, 60.0, 4.0));
  const Counts c = compare_to_formula(
      mirror, {0, 0, radius}, 40.0,
      [&](const Ray& ray) {
        const Vec3 o = ray.origin_mm, d = ray.direction.vec();
        const double z = o.z - radius;
        return first_root(
            d.x * d.x + d.z * d.z, o.x * d.x + z * d.z, o.x * o.x + z * z - radius * radius, [&](double t) {
              const Vec3 p = ray.at(t);
              return p.z <= knots.back().z_mm && std::abs(p.y) <= 30.0 && std::hypot(p.x, p.y) >= 2.0;
            });
      },
      [&](const Vec3& p) {
        return Vec3{-p.x, 0.0, radius - p.z};
      },
      1e-7);
  EXPECT_GT(c.hits, 20000);
  EXPECT_LE(c.differ, 1);
}

// Watertight: from inside a closed sphere nothing gets out, whatever the direction, also along the axis, in
// level planes, through joints of pieces, and along the meridians.
TEST(CurveKernel, NothingLeavesAClosedSphere) {
  const Reflector mirror = deep_ellipse_reflector(20.0, 20.0, 0.0);
  const ReferenceTracer tracer(mirror);
  Rng rng(2, 0);
  for (int i = 0; i < 200000; ++i) {
    Vec3 o = random_point(rng, 11.0) + Vec3{0, 0, 20.0};
    Vec3 d = random_direction(rng).vec();
    const auto& pieces = mirror.curve->pieces();
    const CurvePiece& p = pieces[static_cast<std::size_t>(i) % pieces.size()];
    switch (i % 8) {
      case 1:
        d = {0.0, 0.0, d.z};
        break;
      case 2:
        d.z = 0.0;
        break;
      case 3:
        o.x = o.y = 0.0;
        break;
      case 4:
        d = Vec3{p.r[0], 0.0, p.z[0]} - o;
        break;
      case 5:
        o.y = 0.0;
        d.y = 0.0;
        break;
      case 6:
        o = {0.0, 0.0, 20.0};
        d = Vec3{p.r[0], 0.0, p.z[0]} - o;
        break;
      default:
        break;
    }
    if (length(d) == 0.0) continue;
    const auto hit = tracer.first_hit({o, Direction::from(d)});
    ASSERT_TRUE(hit) << i;
    EXPECT_TRUE(hit->front);
    EXPECT_NEAR(length(hit->point_mm - Vec3{0, 0, 20.0}), 20.0, 1e-7);
  }
}

// In a sphere every reflection turns the point about the same axis by twice the angle between ray and wall:
// 50 reflections in a row, whispering ones too, stay on the formula, and no ray hits its own start. Each hit
// is put a hair inside the wall, which turns the next one by more; the formula has that too. What is left is
// the spline's normal, right to 5e-7: should it err to one side k times, the place is off by 2 R 5e-7 k^2;
// and its height, right to 1e-9.
TEST(CurveKernel, ManyReflectionsInASphere) {
  const double radius = 20.0, hair = 1e-11 * (1.0 + 1.01 * radius + 2.0 * radius);
  const ReferenceTracer tracer(deep_ellipse_reflector(radius, radius, 0.0));
  const Vec3 centre{0, 0, radius};
  Rng rng(3, 0);
  for (int i = 0; i < 2000; ++i) {
    const double grazing = i % 4 == 0 ? 1e-3 : 1.0;
    const Direction start = random_direction(rng);
    const Frame at = Frame::from_z(start);
    double tilt = grazing * radians(1.0 + 88.0 * rng.uniform()), turned = 0.0, inside = 1e-8;
    const double turn = 6.28 * rng.uniform();
    Ray ray{centre + (radius - inside) * start.vec(),
            at.direction(Direction::from(
                {std::cos(tilt) * std::cos(turn), std::cos(tilt) * std::sin(turn), -std::sin(tilt)}))};
    const Direction axis = Direction::from(cross(start.vec(), ray.direction.vec()));
    for (int k = 1; k <= 50; ++k) {
      const auto hit = tracer.first_hit(ray);
      ASSERT_TRUE(hit && hit->front) << i << ", " << k;
      // cos(next) = (1 - inside / radius) cos(tilt), without cancellation.
      const double c = std::cos(tilt),
                   s2 = std::pow(std::sin(tilt), 2) + c * c * (2.0 - inside / radius) * inside / radius;
      const double next = std::asin(std::sqrt(s2));
      turned += tilt + next;
      const Vec3 expected = centre + radius * Frame::rotation(axis, turned).vector(start.vec());
      EXPECT_LT(length(hit->point_mm - expected), 2.0 * radius * 5e-7 * k * k + k * 1e-9 / tilt)
          << i << ", " << k;
      ray = {hit->point_mm, reflect(ray.direction, hit->normal)};
      tilt = next;
      inside = hair;
    }
  }
}

}  // namespace
}  // namespace lucerna
