// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "lucerna/geometry.h"

namespace lucerna {

struct MeshSurface;

/// Three indices of points.
using Triangle = std::array<std::uint32_t, 3>;

/// The convex hull of at least 4 points that do not all lie in a plane (else InputError), as triangles in no
/// particular order and orientation. Coplanar and nearly coplanar points are ordinary input: Qhull (C. B.
/// Barber, D. P. Dobkin, H. Huhdanpaa, ACM Trans. Math. Software 22(4), 1996) joggles them by about 1e-12 of
/// their extent, always in the same way.
std::vector<Triangle> convex_hull(std::span<const Vec3> points);

/// Triangles over points of a convex surface: the Delaunay triangulation on the sphere of directions from the
/// surface's centre (the hull of the points cast on that sphere), or of the plane. Points that lie where the
/// surface is flat, on edges or on a circle need no care. A closed mesh is completed by `helpers` where the
/// points leave a large part of the directions empty (an open dome): those are points of its own, and their
/// triangles are no part of the surface.
struct Triangulation {
  /// The points given, then the helpers, as seen from the centre (point - centre).
  std::vector<Vec3> arms;
  std::size_t points = 0;
  /// Positive orientation: dot(arm0, cross(arm1, arm2)) > 0 but for slivers.
  std::vector<Triangle> triangles;
  /// `neighbours[t][k]` shares the edge opposite to corner k of t; kNoTriangle at the rim of a plane's mesh.
  std::vector<Triangle> neighbours;
  /// Some triangle of each point or helper; kNoTriangle where there is none.
  std::vector<std::uint32_t> triangle_of;

  static constexpr std::uint32_t kNoTriangle = ~std::uint32_t{0};

  bool is_helper(std::uint32_t v) const { return v >= points; }
  bool has_helper(const Triangle& t) const { return is_helper(t[0]) || is_helper(t[1]) || is_helper(t[2]); }
};

/// For surfaces with an area. `points` are distinct and on the surface; any number of them, also none of
/// whose triangles exist (fewer than 3 in a plane).
Triangulation triangulate(const MeshSurface& surface, std::span<const Vec3> points);

/// Where a point of the surface is in a triangulation: its triangle and barycentric coordinates there
/// (clamped to >= 0 beyond the rim), found by walking from triangle `start`; about 0.05 us a step.
/// kNoTriangle if there are no triangles.
struct MeshPlace {
  std::uint32_t triangle = Triangulation::kNoTriangle;
  std::array<double, 3> barycentric{};
};
MeshPlace locate(const Triangulation& mesh, const Vec3& arm, std::uint32_t start);

}  // namespace lucerna
