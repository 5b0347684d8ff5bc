// SPDX-License-Identifier: Apache-2.0
// Hit by hit with clear bodies: the tracer of solids, on cones and splines in double and on triangles with
// distances in double, against Embree on fine triangles in float. Every disagreement is put down to its
// cause.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <iostream>
#include <memory>
#include <mutex>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/mesh.h"
#include "lucerna/optics/shapes/outline.h"
#include "lucerna/random.h"
#include "lucerna/scene.h"
#include "lucerna/trace/engines/body_tracer.h"
#include "lucerna/trace/engines/solid_tracer.h"
#include "tests/support/random_direction.h"
#include "tests/support/spline_face.h"

namespace lucerna {
namespace {

/// Rounding of coordinates of these sizes to float, and what Embree steps over where a ray starts.
constexpr double kFloat_mm = 1e-5, kStart_mm = 1e-3;
/// No ray comes from farther away, or the body is larger.
constexpr double kReach_mm = 16.0;

struct NamedSolid {
  std::string name;
  Solid solid;
};

Solid of_outline(std::vector<std::array<double, 2>> corners) {
  Solid s;
  s.outline_mm = std::move(corners);
  return s;
}

/// A ball, a collimator with curved sides, lenses with one and two free-form faces, and the collimator as
/// triangles.
std::vector<NamedSolid> solids_of_all_kinds() {
  std::vector<std::array<double, 2>> ball;
  for (int i = 0; i <= 40; ++i) {
    const double a = std::numbers::pi * (i / 40.0 - 0.5);
    ball.push_back({i == 0 || i == 40 ? 0.0 : 10.0 * std::cos(a), 10.0 * std::sin(a)});
  }
  const Solid collimator = of_outline(
      {{0, 4}, {2, 3.6}, {2.2, 0.1}, {3, 0.1}, {6, 4}, {9, 9}, {11, 14}, {11, 15}, {7, 15.2}, {0, 15.6}});
  Solid lens = of_outline({{0, 0}, {10, 0}, {10, 2}});
  lens.face = test::spline_face(
      [](double x, double y) {
        return 5.0 - 0.012 * x * x - 0.02 * y * y + 0.1 * std::sin(0.5 * x + 0.3 * y);
      },
      11.0, 24);
  Solid hollow = lens;
  hollow.outline_mm = {{6, 1}, {6, 0}, {10, 0}, {10, 2}};
  hollow.bottom_face = test::spline_face(
      [](double x, double y) { return 2.5 - 0.03 * x * x - 0.02 * y * y + 0.1 * std::sin(0.6 * x - y); }, 7.0,
      24);
  Solid triangles;
  triangles.mesh = surface_mesh(collimator, 1e-3);
  return {{"ball", of_outline(ball)},
          {"collimator", collimator},
          {"lens with a face", lens},
          {"lens with two faces", hollow},
          {"triangles", triangles}};
}

struct SolidHitCounts {
  std::size_t rays = 0, hits = 0;
  /// The ray starts on the surface; it passes within the tolerance of an edge or of a silhouette; none of
  /// both.
  std::size_t starts = 0, edges = 0, unexplained = 0;

  SolidHitCounts& operator+=(const SolidHitCounts& o) {
    rays += o.rays;
    hits += o.hits;
    starts += o.starts;
    edges += o.edges;
    unexplained += o.unexplained;
    return *this;
  }
};

std::ostream& operator<<(std::ostream& out, const SolidHitCounts& c) {
  return out << fmt::format(
             "{} rays, {} hits; differ: {} start on it, {} at an edge or grazing, {} unexplained", c.rays,
             c.hits, c.starts, c.edges, c.unexplained);
}

/// Both tracers of one body.
class SolidPair {
 public:
  SolidPair(const Solid& solid, double tolerance) : own_({solid}), embree_({body_of(solid, tolerance)}) {
    // The mesh of a body of triangles is the same one.
    off_mm_ = kFloat_mm + (solid.mesh != nullptr ? 0.0 : 2.0 * tolerance * kReach_mm);
  }

  void compare(const Ray& ray, SolidHitCounts& c) const {
    ++c.rays;
    const auto expected = embree_.first_hit(ray, 1e6, false);
    const auto found = own_.first_hit(ray, 1e6, false);
    c.hits += expected ? 1 : 0;
    if (agree(found, expected, ray)) return;
    if ((found && found->t_mm < kStart_mm + off_mm_) || (expected && expected->t_mm < 2.0 * kStart_mm)) {
      ++c.starts;
    } else if (agrees_beside(ray, expected)) {
      ++c.edges;
    } else {
      ++c.unexplained;
    }
  }

 private:
  /// A surface of revolution is cut more finely about its axis than `surface_mesh` does.
  static Body body_of(const Solid& solid, double tolerance) {
    Body body;
    body.mesh = surface_mesh(solid, tolerance);
    if (solid.outline_mm.empty() || solid.face != nullptr) return body;
    std::vector<OutlinePoint> corners;
    for (const OutlineSide& side :
         outline_sides(solid.outline_mm, solid.smooth_below_deg, tolerance * kReach_mm)) {
      if (corners.empty() || corners.back() != side.from) corners.push_back(side.from);
      corners.push_back(side.to);
    }
    if (corners.back() == corners.front()) corners.pop_back();
    const int segments = static_cast<int>(std::ceil(std::numbers::pi / std::sqrt(2.0 * tolerance)));
    body.mesh = std::make_shared<const Mesh>(solid_of_revolution(corners, segments));
    return body;
  }

  bool agree(const std::optional<GlassHit>& found, const std::optional<BodyHit>& expected,
             const Ray& ray) const {
    if (found.has_value() != expected.has_value()) return false;
    if (!found) return true;
    const double cosine = std::abs(dot(ray.direction, expected->face));
    return std::abs(found->t_mm - expected->t_mm) * cosine <= off_mm_;
  }

  /// Does a ray that is moved aside by twice the tolerance meet what Embree's meets?
  bool agrees_beside(const Ray& ray, const std::optional<BodyHit>& expected) const {
    const Frame across = Frame::from_z(ray.direction);
    for (int k = 0; k < 8; ++k) {
      const double a = 0.25 * std::numbers::pi * k;
      const Vec3 aside = 2.0 * off_mm_ * (std::cos(a) * across.ex() + std::sin(a) * across.ey());
      const Ray moved{ray.origin_mm + aside, ray.direction};
      if (agree(own_.first_hit(moved, 1e6, false), expected, moved)) return true;
    }
    return false;
  }

  SolidTracer own_;
  BodyTracer embree_;
  double off_mm_;
};

/// Rays from everywhere in and about the body.
SolidHitCounts compared(const Solid& solid, double tolerance, std::size_t rays) {
  const SolidPair pair(solid, tolerance);
  SolidHitCounts sum;
  std::mutex mutex;
  parallel_blocks(rays, 4096, [&](std::size_t first, std::size_t last) {
    SolidHitCounts c;
    for (std::size_t i = first; i < last; ++i) {
      Rng rng(31, i);
      const Direction d = test::random_direction(rng);
      const auto place = [&](double low, double high) {
        return static_cast<double>(static_cast<float>(low + (high - low) * rng.uniform()));
      };
      const double x = place(-12.0, 12.0), y = place(-12.0, 12.0);
      pair.compare({{x, y, place(-12.0, 17.0)}, d}, c);
    }
    const std::lock_guard lock(mutex);
    sum += c;
  });
  return sum;
}

SolidHitCounts compared_all(double tolerance, std::size_t rays_each) {
  SolidHitCounts all;
  for (const NamedSolid& s : solids_of_all_kinds()) {
    const SolidHitCounts c = compared(s.solid, tolerance, rays_each);
    std::cout << s.name << ": " << c << '\n';
    EXPECT_GT(c.hits, c.rays / 5) << s.name;
    EXPECT_EQ(c.unexplained, 0u) << s.name;
    all += c;
  }
  return all;
}

TEST(SolidHits, AreThoseOfEmbreeOnFineTriangles) {
  const SolidHitCounts all = compared_all(1e-5, 20'000);
  EXPECT_LT(all.starts + all.edges, all.rays / 500) << all;
}

// The comparison sees a body that is larger by 1e-4 of its size.
TEST(SolidHits, ALargerBodyIsSeen) {
  const Solid ball = solids_of_all_kinds().front().solid;
  Solid larger = ball;
  for (auto& corner : larger.outline_mm) corner = {1.0001 * corner[0], 1.0001 * corner[1]};
  const SolidTracer own({larger});
  Body body;
  body.mesh = surface_mesh(ball, 1e-5);
  // Along the axis, where its mesh is as good as its outline.
  const auto hit = BodyTracer({body}).first_hit({{0, 0, 0}, Direction::from({0, 0, 1})}, 1e6, false);
  const auto found = own.first_hit({{0, 0, 0}, Direction::from({0, 0, 1})}, 1e6, false);
  ASSERT_TRUE(hit && found);
  EXPECT_GT(std::abs(hit->t_mm - found->t_mm), kFloat_mm + 1e-5 * kReach_mm);
}

// 10^7 rays; counts are printed.
TEST(SolidHitsSlow, TenMillionRaysOverAllKinds) {
  const SolidHitCounts all = compared_all(1e-5, 2'500'000);
  std::cout << "all: " << all << '\n';
  EXPECT_GE(all.rays, 10'000'000u);
  EXPECT_LT(static_cast<double>(all.starts + all.edges), 1e-3 * static_cast<double>(all.rays));
}

}  // namespace
}  // namespace lucerna
