// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/mesh_triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source/clusters/mesh_surface.h"

namespace lucerna {
namespace {

MeshSurface make_surface(MeshSurfaceKind kind) {
  MeshSurface s;
  s.kind = kind;
  s.radius_mm = 2.0;
  s.half_size_mm = {2.0, 2.0, 3.0};
  if (kind == MeshSurfaceKind::plane) s.centre_mm = {0, 0, -1};
  return s;
}

Vec3 random_point(const MeshSurface& s, Rng& rng) {
  const Vec3 p{4 * rng.uniform() - 2, 4 * rng.uniform() - 2, 4 * rng.uniform() - 2};
  return s.put_back(p);
}

std::vector<Vec3> random_points(const MeshSurface& s, std::size_t n, std::uint64_t seed) {
  std::vector<Vec3> points;
  Rng rng(seed, 0);
  for (std::size_t i = 0; i < n; ++i) points.push_back(random_point(s, rng));
  return points;
}

void expect_whole(const Triangulation& mesh, bool closed) {
  std::set<std::uint32_t> used;
  std::size_t rims = 0;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      used.insert(mesh.triangles[t][k]);
      const std::uint32_t other = mesh.neighbours[t][k];
      if (other == Triangulation::kNoTriangle) {
        ++rims;
        continue;
      }
      const auto& back = mesh.neighbours[other];
      EXPECT_TRUE(back[0] == t || back[1] == t || back[2] == t);
    }
  }
  EXPECT_EQ(used.size(), mesh.arms.size()) << "every point is a corner";
  if (closed) {
    EXPECT_EQ(rims, 0u);
    EXPECT_EQ(mesh.triangles.size(), 2 * mesh.arms.size() - 4) << "Euler";
  }
}

TEST(Triangulation, ClosedSurfacesAndPlanesAreCoveredWhateverIsCoplanar) {
  for (const MeshSurfaceKind kind : {MeshSurfaceKind::sphere, MeshSurfaceKind::cylinder, MeshSurfaceKind::box,
                                     MeshSurfaceKind::hull, MeshSurfaceKind::plane}) {
    const MeshSurface s = make_surface(kind);
    // Hull: points of the box, taken as they are. A regular grid has four points on every circle.
    auto points =
        random_points(kind == MeshSurfaceKind::hull ? make_surface(MeshSurfaceKind::box) : s, 300, 1);
    if (kind == MeshSurfaceKind::plane) {
      points.clear();
      for (int x = 0; x < 12; ++x) {
        for (int y = 0; y < 9; ++y) points.push_back({0.25 * x, 0.25 * y, 0.0});
      }
    }
    const Triangulation mesh = triangulate(s, points);
    EXPECT_EQ(mesh.arms.size(), points.size());
    expect_whole(mesh, kind != MeshSurfaceKind::plane);
    for (std::uint64_t i = 0; i < 500; ++i) {
      Rng rng(2, i);
      Vec3 p = random_point(kind == MeshSurfaceKind::hull ? make_surface(MeshSurfaceKind::box) : s, rng);
      if (kind == MeshSurfaceKind::plane) p = {2.75 * rng.uniform(), 2.0 * rng.uniform(), 0.0};
      const Vec3 arm = p - s.centre_mm;
      const MeshPlace place = locate(mesh, arm, static_cast<std::uint32_t>(i % mesh.triangles.size()));
      // The barycentric combination of the corners lies on the line from the centre through the point.
      Vec3 q;
      for (std::size_t k = 0; k < 3; ++k)
        q += place.barycentric[k] * mesh.arms[mesh.triangles[place.triangle][k]];
      EXPECT_LT(length(cross(q, arm)) / (length(q) * length(arm)), 1e-6) << to_string(kind);
    }
  }
}

TEST(Triangulation, AnOpenDomeIsClosedByHelpers) {
  const MeshSurface s = make_surface(MeshSurfaceKind::sphere);
  auto points = random_points(s, 200, 3);
  for (Vec3& p : points) p.z = std::abs(p.z);
  const Triangulation mesh = triangulate(s, points);
  EXPECT_GT(mesh.arms.size(), points.size());
  expect_whole(mesh, true);
}

TEST(Triangulation, FewPointsWork) {
  for (std::size_t n = 1; n <= 5; ++n) {
    const auto points = random_points(make_surface(MeshSurfaceKind::sphere), n, 4 + n);
    expect_whole(triangulate(make_surface(MeshSurfaceKind::sphere), points), true);
  }
  const MeshSurface plane = make_surface(MeshSurfaceKind::plane);
  EXPECT_TRUE(triangulate(plane, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}}).triangles.empty());
  EXPECT_EQ(triangulate(plane, std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}).triangles.size(), 1u);
  EXPECT_EQ(locate(triangulate(plane, std::vector<Vec3>{}), {}, 0).triangle, Triangulation::kNoTriangle);
}

TEST(ConvexHull, TooFewPointsAreAnError) {
  EXPECT_THROW(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), InputError);
}

RayBlock starts(std::span<const Vec3> points) {
  RayBlock rays;
  rays.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    rays.set(i, {points[i] + Vec3{5, -3, 2}, Direction::from({0.1, 0.2, 1})});
    rays.weight[i] = 1.0f;
  }
  return rays;
}

TEST(MeshSurface, IsFoundFromTheStarts) {
  for (const MeshSurfaceKind kind :
       {MeshSurfaceKind::plane, MeshSurfaceKind::sphere, MeshSurfaceKind::cylinder, MeshSurfaceKind::box}) {
    const auto points = random_points(make_surface(kind), 5000, 11);
    const FoundSurface found = find_mesh_surface(starts(points));
    EXPECT_EQ(found.surface.kind, kind) << to_string(found.surface.kind);
    EXPECT_FALSE(found.slide);
    for (const Vec3& p : points) {
      EXPECT_LT(length(found.surface.put_back(p + Vec3{5, -3, 2}) - (p + Vec3{5, -3, 2})), 1e-2)
          << to_string(kind);
    }
  }
  // An ellipsoid is its own hull; a ball of starts is nothing, and rays slide to a sphere.
  auto points = random_points(make_surface(MeshSurfaceKind::sphere), 5000, 12);
  for (Vec3& p : points) p = {p.x, 0.7 * p.y, 1.5 * p.z};
  EXPECT_EQ(find_mesh_surface(starts(points)).surface.kind, MeshSurfaceKind::hull);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = std::cbrt(Rng(13, i).uniform()) * points[i];
  EXPECT_TRUE(find_mesh_surface(starts(points)).slide);
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = {3.0 * Rng(14, i).uniform(), 0, 0};
  EXPECT_EQ(find_mesh_surface(starts(points)).surface.kind, MeshSurfaceKind::line);
  for (Vec3& p : points) p = {1, 2, 3};
  EXPECT_EQ(find_mesh_surface(starts(points)).surface.kind, MeshSurfaceKind::point);
}

TEST(MeshSurface, NormalsPointOut) {
  for (const MeshSurfaceKind kind :
       {MeshSurfaceKind::sphere, MeshSurfaceKind::cylinder, MeshSurfaceKind::box}) {
    const MeshSurface s = make_surface(kind);
    for (const Vec3& p : random_points(s, 100, 15)) {
      EXPECT_NEAR(length(s.normal(p)), 1.0, 1e-12);
      EXPECT_GT(dot(s.normal(p), p), 0.0);
      EXPECT_LT(length(s.put_back(p + 1e-3 * s.normal(p)) - p), 3e-3);
    }
  }
}

}  // namespace
}  // namespace lucerna
