// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/clusters/mesh_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "lucerna/core/io/error.h"
#include "lucerna/rayset/statistics/surface_guess.h"
#include "lucerna/source/clusters/mesh_triangulation.h"

namespace lucerna {

namespace {

constexpr std::array<std::string_view, 7> kSurfaceNames{"point",    "line", "plane", "sphere",
                                                        "cylinder", "box",  "hull"};
/// Share of the flux that must start on a surface; strays are put back on it.
constexpr double kMinShare = 0.99;
/// The facets of a hull of some thousand points lie below the surface that they sample by up to about this
/// share.
constexpr double kHullTolerance = 1e-2;
constexpr std::size_t kLookAt = std::size_t{1} << 16, kHullPoints = 3000;

using Points = std::vector<Vec3>;

Points look_at(const RayBlock& rays) {
  const std::size_t n = rays.size(), m = std::min(n, kLookAt);
  Points points(m);
  for (std::size_t i = 0; i < m; ++i) points[i] = rays.origin_mm(i * n / m);
  return points;
}

Vec3 mean_of(const Points& points) {
  Vec3 sum;
  for (const Vec3& p : points) sum += p;
  return sum / static_cast<double>(points.size());
}

double size_of(const Points& points, const Vec3& mean) {
  double size = 0.0;
  for (const Vec3& p : points) size = std::max(size, length(p - mean));
  return size;
}

std::optional<MeshSurface> as_hull(const Points& points) {
  const Vec3 mean = mean_of(points);
  const double size_mm = size_of(points, mean);
  Points some;
  const std::size_t n = std::min(points.size(), kHullPoints);
  for (std::size_t i = 0; i < n; ++i) some.push_back(points[i * points.size() / n]);
  struct Plane {
    Vec3 normal;
    double offset;
  };
  std::vector<Plane> planes;
  for (const Triangle& t : convex_hull(some)) {
    const Vec3 normal = cross(some[t[1]] - some[t[0]], some[t[2]] - some[t[0]]);
    const double size = length(normal);
    if (size < 1e-9 * size_mm * size_mm) continue;  // slivers on flat faces have no direction of their own
    const double sign = dot(normal, some[t[0]] - mean) < 0.0 ? -1.0 : 1.0;
    planes.push_back({(sign / size) * normal, dot((sign / size) * normal, some[t[0]])});
  }
  for (const Vec3& p : some) {
    double inside = 1e300;
    for (const Plane& plane : planes) inside = std::min(inside, plane.offset - dot(plane.normal, p));
    if (inside > kHullTolerance * size_mm) return std::nullopt;
  }
  return MeshSurface{MeshSurfaceKind::hull, {}, 0.0, {}, mean};
}

Vec3 box_normal(const Vec3& local, const Vec3& half) {
  const std::array<double, 3> x{local.x, local.y, local.z}, h{half.x, half.y, half.z};
  std::size_t face = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (std::abs(x[k]) - h[k] > std::abs(x[face]) - h[face]) face = k;
  }
  std::array<double, 3> normal{};
  normal[face] = x[face] < 0.0 ? -1.0 : 1.0;
  return {normal[0], normal[1], normal[2]};
}

}  // namespace

std::string_view to_string(MeshSurfaceKind kind) { return kSurfaceNames[static_cast<std::size_t>(kind)]; }

Vec3 MeshSurface::normal(const Vec3& point_mm) const {
  if (kind == MeshSurfaceKind::plane) return world_from_surface.ez();
  const Vec3 out = point_mm - centre_mm;
  const double distance = length(out);
  if (kind == MeshSurfaceKind::cylinder || kind == MeshSurfaceKind::box) {
    const Vec3 local = world_from_surface.inverse().point(point_mm);
    if (kind == MeshSurfaceKind::box) return world_from_surface.vector(box_normal(local, half_size_mm));
    const double r = std::hypot(local.x, local.y);
    if (std::abs(local.z) - half_size_mm.z > r - radius_mm) {
      return local.z < 0.0 ? -world_from_surface.ez() : world_from_surface.ez();
    }
    return world_from_surface.vector({local.x / r, local.y / r, 0.0});
  }
  return distance > 0.0 ? out / distance : Vec3{0, 0, 1};
}

namespace {

Frame at(const Vec3& origin_mm) { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, origin_mm}; }

FoundSurface enclosing_sphere(const RayBlock& rays, const Vec3& centre_mm) {
  double radius = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i)
    radius = std::max(radius, length(rays.origin_mm(i) - centre_mm));
  // A little wider: the farthest start, rounded, must still be inside.
  return {{MeshSurfaceKind::sphere, at(centre_mm), 1.001 * radius, {}, centre_mm}, true};
}

}  // namespace

FoundSurface find_mesh_surface(const RayBlock& rays) {
  LUCERNA_CHECK(!rays.empty(), "no rays");
  const SurfaceGuess guess = guess_surface(rays, kMinShare);
  const Points points = look_at(rays);
  const Frame& placed = guess.surface.world_from_surface;
  switch (guess.shape) {
    case StartShape::point:
      return {{MeshSurfaceKind::point, at(guess.point_mm), 0.0, {}, guess.point_mm}};
    case StartShape::line: {
      const Frame z = Frame::from_axis(guess.line, 0.0, guess.point_mm);
      return {
          {MeshSurfaceKind::line, Frame(z.ez(), z.ex(), z.ey(), guess.point_mm), 0.0, {}, guess.point_mm}};
    }
    case StartShape::surface:
      break;
    case StartShape::scattered:
      if (const auto s = as_hull(points)) return {*s};
      return enclosing_sphere(rays, mean_of(points));
  }
  MeshSurface s{MeshSurfaceKind::sphere, placed, guess.surface.radius_mm, guess.surface.half_size_mm,
                placed.origin_mm()};
  if (guess.surface.kind == SurfaceKind::cylinder) s.kind = MeshSurfaceKind::cylinder;
  if (guess.surface.kind == SurfaceKind::box) s.kind = MeshSurfaceKind::box;
  if (guess.surface.kind == SurfaceKind::plane) {
    s.kind = MeshSurfaceKind::plane;
    const Vec3 middle = mean_of(points);
    s.centre_mm = s.put_back(middle) - size_of(points, middle) * placed.ez();
  }
  return {s};
}

}  // namespace lucerna
