// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string_view>

#include "lucerna/bounding_surface.h"
#include "lucerna/geometry.h"
#include "lucerna/rays.h"

namespace lucerna {

/// What the starts of a ray set lie on.
enum class MeshSurfaceKind : std::uint8_t {
  point = 0,
  line = 1,
  plane = 2,
  sphere = 3,
  cylinder = 4,
  box = 5,
  hull = 6
};

std::string_view to_string(MeshSurfaceKind kind);

/// The convex surface that carries a mesh of representatives, as seen from a point `centre_mm` inside it (for
/// a plane: behind it), so that every line from there hits it once. Immutable, thread safe.
struct MeshSurface {
  MeshSurfaceKind kind = MeshSurfaceKind::point;
  /// point: the point. line: x is along it, the origin on it. plane: z is its normal, the origin on it.
  /// sphere, cylinder, box: as BoundingSurface. hull: the identity.
  Frame world_from_surface;
  /// Sphere, cylinder.
  double radius_mm = 0.0;
  /// Cylinder (z), box.
  Vec3 half_size_mm;
  Vec3 centre_mm;

  /// The point of the surface that belongs to a point near it: on the line from the centre for sphere,
  /// cylinder and box; the nearest one for point, line and plane; for a hull the point itself (its facets are
  /// the mesh).
  LUCERNA_HD Vec3 put_back(const Vec3& point_mm) const;

  /// Outward unit normal at a point of the surface; for hull, line and point the direction from the centre
  /// (+z if none).
  Vec3 normal(const Vec3& point_mm) const;

  /// True where points can be anywhere on an area, so that `pdf_area` exists.
  bool has_area() const { return kind >= MeshSurfaceKind::plane; }

  friend bool operator==(const MeshSurface&, const MeshSurface&) = default;
};

namespace detail {
/// The same as a body, for sphere, cylinder and box.
LUCERNA_HD inline BoundingSurface bounding(const MeshSurface& s) {
  const SurfaceKind kind = s.kind == MeshSurfaceKind::sphere     ? SurfaceKind::sphere
                           : s.kind == MeshSurfaceKind::cylinder ? SurfaceKind::cylinder
                                                                 : SurfaceKind::box;
  return {kind, s.world_from_surface, s.radius_mm, s.half_size_mm};
}
}  // namespace detail

LUCERNA_HD inline Vec3 MeshSurface::put_back(const Vec3& point_mm) const {
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
  const auto t = detail::bounding(*this).exit_distance_mm(ray);
  return t ? ray.at(*t) : point_mm;
}

/// A surface, and whether rays had to leave their starts to be on it.
struct FoundSurface {
  MeshSurface surface;
  /// The starts lie on no convex surface: rays are slid forward along their lines to `surface`, a sphere
  /// about them all.
  bool slide = false;
};

/// The surface that the starts lie on: what rayset/statistics/surface_guess.h finds for 99 % of the flux
/// (point, line, plane, sphere, cylinder, box), their own convex hull if no start of some thousand lies more
/// than 1 % of the extent inside it, else a sphere round them. Needs one ray. Deterministic.
FoundSurface find_mesh_surface(const RayBlock& rays);

}  // namespace lucerna
