// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/bounding_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lucerna/core/error.h"

namespace lucerna {

namespace {

constexpr std::array<std::string_view, 5> kSurfaceNames{"none", "plane", "sphere", "cylinder", "box"};

struct Interval {
  double near, far;
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// The part of the line o + t d inside |x| <= half. A line parallel to the slab is inside everywhere or
/// nowhere.
std::optional<Interval> inside_slab(double o, double d, double half) {
  if (d == 0.0) {
    if (std::abs(o) > half) return std::nullopt;
    return Interval{-kInfinity, kInfinity};
  }
  const double a = (-half - o) / d, b = (half - o) / d;
  return Interval{std::min(a, b), std::max(a, b)};
}

/// The part of the line inside |o + t d|^2 <= radius^2, of the vectors given (three components, or two for a
/// cylinder).
std::optional<Interval> inside_round(const Vec3& o, const Vec3& d, double radius) {
  const double a = dot(d, d);
  if (a == 0.0) return inside_slab(length(o), 0.0, radius);
  const double b = dot(o, d);
  // The distance of the line from the centre first: no cancellation for far starts.
  const Vec3 nearest = o - (b / a) * d;
  const double rest = radius * radius - dot(nearest, nearest);
  if (rest < 0.0) return std::nullopt;
  const double half = std::sqrt(rest / a);
  return Interval{-b / a - half, -b / a + half};
}

std::optional<Interval> both(std::optional<Interval> a, std::optional<Interval> b) {
  if (!a || !b) return std::nullopt;
  const Interval common{std::max(a->near, b->near), std::min(a->far, b->far)};
  if (common.near > common.far) return std::nullopt;
  return common;
}

}  // namespace

std::string_view to_string(SurfaceKind kind) { return kSurfaceNames[static_cast<std::size_t>(kind)]; }

SurfaceKind surface_kind(std::string_view name) {
  const auto found = std::find(kSurfaceNames.begin(), kSurfaceNames.end(), name);
  if (found == kSurfaceNames.end()) {
    throw UsageError(fmt::format("unknown surface '{}'; expected {}", name, fmt::join(kSurfaceNames, ", ")));
  }
  return static_cast<SurfaceKind>(found - kSurfaceNames.begin());
}

BoundingSurface BoundingSurface::plane(double z_mm) {
  return {SurfaceKind::plane, Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, z_mm}), 0.0, {}};
}
BoundingSurface BoundingSurface::sphere(double radius_mm) { return {SurfaceKind::sphere, {}, radius_mm, {}}; }
BoundingSurface BoundingSurface::cylinder(double radius_mm, double length_mm) {
  return {SurfaceKind::cylinder, {}, radius_mm, {radius_mm, radius_mm, 0.5 * length_mm}};
}
BoundingSurface BoundingSurface::box(const Vec3& size_mm) {
  return {SurfaceKind::box, {}, 0.0, 0.5 * size_mm};
}

BoundingSurface BoundingSurface::from_sizes(SurfaceKind kind, std::span<const double> mm) {
  constexpr std::array<std::size_t, 5> kCounts{0, 1, 1, 2, 3};
  const std::size_t expected = kCounts[static_cast<std::size_t>(kind)];
  if (mm.size() != expected) {
    throw InputError(
        fmt::format("a {} surface takes {} number(s), found {}", to_string(kind), expected, mm.size()));
  }
  for (const double value : mm) {
    if (kind != SurfaceKind::plane && !(value > 0.0)) {
      throw InputError(fmt::format("a {} surface of size {}, expected > 0", to_string(kind), value));
    }
  }
  switch (kind) {
    case SurfaceKind::none:
      return {};
    case SurfaceKind::plane:
      return plane(mm[0]);
    case SurfaceKind::sphere:
      return sphere(mm[0]);
    case SurfaceKind::cylinder:
      return cylinder(mm[0], mm[1]);
    case SurfaceKind::box:
      return box({mm[0], mm[1], mm[2]});
  }
  return {};
}

double BoundingSurface::outside_mm(const Vec3& point_mm) const {
  const Vec3 p = world_from_surface.inverse().point(point_mm);
  switch (kind) {
    case SurfaceKind::none:
      return 0.0;
    case SurfaceKind::plane:
      return p.z;
    case SurfaceKind::sphere:
      return length(p) - radius_mm;
    case SurfaceKind::cylinder:
      return std::max(std::hypot(p.x, p.y) - radius_mm, std::abs(p.z) - half_size_mm.z);
    case SurfaceKind::box:
      return std::max(
          {std::abs(p.x) - half_size_mm.x, std::abs(p.y) - half_size_mm.y, std::abs(p.z) - half_size_mm.z});
  }
  return 0.0;
}

std::optional<double> BoundingSurface::exit_distance_mm(const Ray& ray) const {
  const Frame surface_from_world = world_from_surface.inverse();
  const Vec3 o = surface_from_world.point(ray.origin_mm), d = surface_from_world.vector(ray.direction);
  std::optional<Interval> inside;
  switch (kind) {
    case SurfaceKind::none:
      return std::nullopt;
    case SurfaceKind::plane:
      if (d.z <= 0.0) return std::nullopt;
      return -o.z / d.z;
    case SurfaceKind::sphere:
      inside = inside_round(o, d, radius_mm);
      break;
    case SurfaceKind::cylinder:
      inside = both(inside_round({o.x, o.y, 0.0}, {d.x, d.y, 0.0}, radius_mm),
                    inside_slab(o.z, d.z, half_size_mm.z));
      break;
    case SurfaceKind::box:
      inside = both(inside_slab(o.x, d.x, half_size_mm.x),
                    both(inside_slab(o.y, d.y, half_size_mm.y), inside_slab(o.z, d.z, half_size_mm.z)));
      break;
  }
  if (!inside) return std::nullopt;
  return inside->far;
}

}  // namespace lucerna
