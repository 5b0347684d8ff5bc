// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "lucerna/geometry.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// The shapes that a bounding surface can have.
enum class SurfaceKind { none, plane, sphere, cylinder, box };

/// "none", "plane", "sphere", "cylinder", "box".
std::string_view to_string(SurfaceKind kind);
/// The kind of such a name. Throws UsageError on anything else.
SurfaceKind surface_kind(std::string_view name);

/// The convex surface that the starts of a ray set lie on, wrapped round its source. Immutable, thread safe.
struct BoundingSurface {
  /// Which shape it is; the sizes below that do not belong to it are ignored.
  SurfaceKind kind = SurfaceKind::none;
  /// Places the surface: plane z = 0 of the frame (light goes to +z), sphere about its origin, cylinder about
  /// its z axis and closed by discs at +-half its length, box about its origin.
  Frame world_from_surface;
  /// Sphere, cylinder.
  double radius_mm = 0.0;
  /// Half the edges of a box; z is also half the length of a cylinder.
  Vec3 half_size_mm;

  /// The plane z = `z_mm`.
  [[nodiscard]] static BoundingSurface plane(double z_mm);
  /// A sphere about the origin; `radius_mm` > 0.
  [[nodiscard]] static BoundingSurface sphere(double radius_mm);
  /// A closed cylinder about the z axis, centred at the origin; both sizes > 0.
  [[nodiscard]] static BoundingSurface cylinder(double radius_mm, double length_mm);
  /// A box about the origin with these edges, each > 0.
  [[nodiscard]] static BoundingSurface box(const Vec3& size_mm);

  /// The same from the numbers that users give: plane Z, sphere RADIUS, cylinder RADIUS LENGTH, box X Y Z,
  /// none nothing. Throws InputError for another count of numbers or sizes that are not > 0.
  [[nodiscard]] static BoundingSurface from_sizes(SurfaceKind kind, std::span<const double> mm);

  /// Signed distance-like measure of a point in mm: < 0 inside (below the plane), 0 on it, > 0 outside; exact
  /// distance on faces. 0 everywhere for `none`.
  double outside_mm(const Vec3& point_mm) const;

  /// Distance along the ray to where its line last leaves the body (for a plane: crosses towards +z); may be
  /// negative when that lies behind the start. Nothing when the line misses it, or for `none`. A ray that
  /// starts inside has exactly one such point ahead of it: where it belongs on the surface.
  LUCERNA_HD std::optional<double> exit_distance_mm(const Ray& ray) const;
};

namespace detail {

struct Interval {
  double near, far;
};

/// The part of the line o + t d inside |x| <= half. A line parallel to the slab is inside everywhere or
/// nowhere.
LUCERNA_HD inline std::optional<Interval> inside_slab(double o, double d, double half) {
  if (d == 0.0) {
    if (std::abs(o) > half) return std::nullopt;
    return Interval{-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  }
  const double a = (-half - o) / d, b = (half - o) / d;
  return Interval{std::min(a, b), std::max(a, b)};
}

/// The part of the line inside |o + t d|^2 <= radius^2, of the vectors given (three components, or two for a
/// cylinder).
LUCERNA_HD inline std::optional<Interval> inside_round(const Vec3& o, const Vec3& d, double radius) {
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

LUCERNA_HD inline std::optional<Interval> both(std::optional<Interval> a, std::optional<Interval> b) {
  if (!a || !b) return std::nullopt;
  const Interval common{std::max(a->near, b->near), std::min(a->far, b->far)};
  if (common.near > common.far) return std::nullopt;
  return common;
}

}  // namespace detail

LUCERNA_HD inline std::optional<double> BoundingSurface::exit_distance_mm(const Ray& ray) const {
  const Frame surface_from_world = world_from_surface.inverse();
  const Vec3 o = surface_from_world.point(ray.origin_mm), d = surface_from_world.vector(ray.direction);
  using namespace detail;
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
#pragma GCC visibility pop
