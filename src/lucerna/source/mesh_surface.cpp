// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/mesh_surface.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "lucerna/core/error.h"
#include "lucerna/source/mesh_triangulation.h"

namespace lucerna {

namespace {

constexpr std::array<std::string_view, 7> kNames{"point",    "line", "plane", "sphere",
                                                 "cylinder", "box",  "hull"};
/// Starts belong to a surface when they are this near, in shares of their extent: text files have four
/// digits.
constexpr double kTolerance = 1e-3;
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

struct Extent {
  Vec3 mean;
  double size = 0.0;              // largest distance from the mean
  std::array<Vec3, 3> axes;       // principal axes, the widest first
  std::array<double, 3> reach{};  // largest distance from the mean along each
};

Extent extent_of(const Points& points) {
  Extent e;
  e.mean = mean_of(points);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Vec3& p : points) {
    const Vec3 q = p - e.mean;
    const Eigen::Vector3d v(q.x, q.y, q.z);
    covariance += v * v.transpose();
    e.size = std::max(e.size, length(q));
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d v = solver.eigenvectors().col(2 - k);
    e.axes[static_cast<std::size_t>(k)] = {v.x(), v.y(), v.z()};
  }
  for (const Vec3& p : points) {
    for (std::size_t k = 0; k < 3; ++k)
      e.reach[k] = std::max(e.reach[k], std::abs(dot(p - e.mean, e.axes[k])));
  }
  return e;
}

/// Centre and radius by linear least squares in `dimensions` (2: x and y) coordinates.
struct Round {
  Vec3 centre;
  double radius = 0.0;
};

std::optional<Round> fit_round(const Points& points, int dimensions, const Vec3& about) {
  const int n = dimensions + 1;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (const Vec3& p : points) {
    const Vec3 q = p - about;
    Eigen::VectorXd row(n);
    row << 2.0 * q.x, 2.0 * q.y, (dimensions == 3 ? 2.0 * q.z : 1.0), Eigen::VectorXd::Ones(n - 3);
    const double value = q.x * q.x + q.y * q.y + (dimensions == 3 ? q.z * q.z : 0.0);
    matrix += row * row.transpose();
    right += value * row;
  }
  const Eigen::VectorXd x = matrix.ldlt().solve(right);
  if (!x.allFinite()) return std::nullopt;
  const Vec3 centre{x[0], x[1], dimensions == 3 ? x[2] : 0.0};
  const double squared = x[n - 1] + dot(centre, centre);
  if (!(squared > 0.0)) return std::nullopt;
  return Round{about + centre, std::sqrt(squared)};
}

std::optional<MeshSurface> as_sphere(const Points& points, const Extent& e) {
  const auto fit = fit_round(points, 3, e.mean);
  // A far centre is a nearly flat cap that any curved patch fits.
  if (!fit || fit->radius > 10.0 * e.size) return std::nullopt;
  for (const Vec3& p : points) {
    if (std::abs(length(p - fit->centre) - fit->radius) > kTolerance * e.size) return std::nullopt;
  }
  MeshSurface s{MeshSurfaceKind::sphere, {}, fit->radius, {}, fit->centre};
  s.world_from_surface = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, fit->centre);
  return s;
}

std::optional<MeshSurface> as_cylinder(const Points& points, const Extent& e, const Vec3& axis) {
  const Frame turned = Frame::from_axis(Direction::from(axis), 0.0, e.mean);
  const Frame inverse = turned.inverse();
  const double tolerance = kTolerance * e.size;
  Points local;
  double low = 1e300, high = -1e300;
  for (const Vec3& p : points) {
    local.push_back(inverse.point(p));
    low = std::min(low, local.back().z);
    high = std::max(high, local.back().z);
  }
  Points mantle;
  for (const Vec3& p : local) {
    if (p.z > low + tolerance && p.z < high - tolerance) mantle.push_back(p);
  }
  if (mantle.size() < 8) return std::nullopt;
  const auto fit = fit_round(mantle, 2, {});
  if (!fit || fit->radius > 10.0 * e.size) return std::nullopt;
  for (const Vec3& p : local) {
    const double r = std::hypot(p.x - fit->centre.x, p.y - fit->centre.y);
    const bool on_mantle = std::abs(r - fit->radius) <= tolerance;
    const bool on_end = (p.z <= low + tolerance || p.z >= high - tolerance) && r <= fit->radius + tolerance;
    if (!on_mantle && !on_end) return std::nullopt;
  }
  MeshSurface s{
      MeshSurfaceKind::cylinder, {}, fit->radius, {fit->radius, fit->radius, 0.5 * (high - low)}, {}};
  s.centre_mm = turned.point({fit->centre.x, fit->centre.y, 0.5 * (low + high)});
  s.world_from_surface = Frame(turned.ex(), turned.ey(), turned.ez(), s.centre_mm);
  return s;
}

std::optional<MeshSurface> as_box(const Points& points, const Extent& e) {
  Vec3 low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
  for (const Vec3& p : points) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  for (const Vec3& p : points) {
    const double inside =
        std::min({p.x - low.x, high.x - p.x, p.y - low.y, high.y - p.y, p.z - low.z, high.z - p.z});
    if (inside > kTolerance * e.size) return std::nullopt;
  }
  MeshSurface s{MeshSurfaceKind::box, {}, 0.0, 0.5 * (high - low), 0.5 * (low + high)};
  s.world_from_surface = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, s.centre_mm);
  return s;
}

std::optional<MeshSurface> as_hull(const Points& points, const Extent& e) {
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
    if (size < 1e-9 * e.size * e.size) continue;  // slivers on flat faces have no direction of their own
    const double sign = dot(normal, some[t[0]] - e.mean) < 0.0 ? -1.0 : 1.0;
    planes.push_back({(sign / size) * normal, dot((sign / size) * normal, some[t[0]])});
  }
  for (const Vec3& p : some) {
    double inside = 1e300;
    for (const Plane& plane : planes) inside = std::min(inside, plane.offset - dot(plane.normal, p));
    if (inside > kHullTolerance * e.size) return std::nullopt;
  }
  return MeshSurface{MeshSurfaceKind::hull, {}, 0.0, {}, e.mean};
}

/// The plane's normal points where the light goes.
MeshSurface as_plane(const RayBlock& rays, const Extent& e) {
  Vec3 mean;
  for (std::size_t i = 0, n = std::min(rays.size(), kLookAt); i < n; ++i)
    mean += rays.direction(i * rays.size() / n);
  const Vec3 normal = dot(mean, e.axes[2]) < 0.0 ? -e.axes[2] : e.axes[2];
  const Frame frame = Frame::from_axis(Direction::from(normal), 0.0, e.mean);
  return {MeshSurfaceKind::plane, frame, 0.0, {}, e.mean - e.size * normal};
}

BoundingSurface bounding(const MeshSurface& s) {
  const SurfaceKind kind = s.kind == MeshSurfaceKind::sphere     ? SurfaceKind::sphere
                           : s.kind == MeshSurfaceKind::cylinder ? SurfaceKind::cylinder
                                                                 : SurfaceKind::box;
  return {kind, s.world_from_surface, s.radius_mm, s.half_size_mm};
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

std::string_view to_string(MeshSurfaceKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

Vec3 MeshSurface::put_back(const Vec3& point_mm) const {
  switch (kind) {
    case MeshSurfaceKind::point:
      return world_from_surface.origin_mm();
    case MeshSurfaceKind::line: {
      const Vec3 x = world_from_surface.ex(), o = world_from_surface.origin_mm();
      return o + dot(point_mm - o, x) * x;
    }
    case MeshSurfaceKind::plane: {
      const Vec3 z = world_from_surface.ez();
      return point_mm - dot(point_mm - world_from_surface.origin_mm(), z) * z;
    }
    case MeshSurfaceKind::hull:
      return point_mm;
    default:
      break;
  }
  const Vec3 out = point_mm - centre_mm;
  const double distance = length(out);
  if (!(distance > 0.0)) return point_mm;
  if (kind == MeshSurfaceKind::sphere) return centre_mm + (radius_mm / distance) * out;
  const Ray ray{centre_mm, Direction::from_unit(out / distance)};
  const auto t = bounding(*this).exit_distance_mm(ray);
  return t ? ray.at(*t) : point_mm;
}

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

FoundSurface find_mesh_surface(const RayBlock& rays) {
  LUCERNA_CHECK(!rays.empty(), "no rays");
  const Points points = look_at(rays);
  const Extent e = extent_of(points);
  // Starts at one point in a file of float32 differ by their rounding.
  const double rounding = 1e-6 * (length(e.mean) + e.size);
  if (e.reach[0] <= rounding) {
    return {{MeshSurfaceKind::point, Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, e.mean), 0.0, {}, e.mean}};
  }
  const double flat = std::max(rounding, kTolerance * e.size);
  if (e.reach[1] <= flat) {
    const Direction along = Direction::from(e.axes[0]);
    const Frame z = Frame::from_axis(along, 0.0, e.mean);
    return {{MeshSurfaceKind::line, Frame(z.ez(), z.ex(), z.ey(), e.mean), 0.0, {}, e.mean}};
  }
  if (e.reach[2] <= flat) return {as_plane(rays, e)};
  if (const auto s = as_sphere(points, e)) return {*s};
  for (const Vec3& axis : {Vec3{0, 0, 1}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, e.axes[0], e.axes[1], e.axes[2]}) {
    if (const auto s = as_cylinder(points, e, axis)) return {*s};
  }
  if (const auto s = as_box(points, e)) return {*s};
  if (const auto s = as_hull(points, e)) return {*s};
  double radius = 0.0;
  for (std::size_t i = 0; i < rays.size(); ++i) radius = std::max(radius, length(rays.origin_mm(i) - e.mean));
  MeshSurface s{
      MeshSurfaceKind::sphere, Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, e.mean), 1.001 * radius, {}, e.mean};
  return {s, true};
}

}  // namespace lucerna
