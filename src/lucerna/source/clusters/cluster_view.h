// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "lucerna/source/clusters/alias_table.h"
#include "lucerna/source/clusters/mesh_surface.h"
#include "lucerna/source/clusters/mesh_triangulation.h"
#include "lucerna/source/clusters/spherical_triangle.h"

namespace lucerna {

/// A piece of the mesh fine enough that flat and surface areas agree; its corners are on the surface.
struct MeshPiece {
  std::array<Vec3, 3> corner_mm;
  /// Each corner's coordinates in its element: what its density is interpolated with.
  std::array<std::array<double, 3>, 3> share{};
  std::array<double, 3> density{};  // relative, at the corners
  std::uint32_t element = 0;
  /// mm^2, mm or 1 by the element's shape.
  double measure = 0.0;
};

/// 1 point, 2 segment, 3 triangle.
LUCERNA_HD inline int mesh_corners(const Triangle& e) { return e[0] == e[1] ? 1 : e[1] == e[2] ? 2 : 3; }

/// lambda with density 6 lambda (1 - lambda): the corner coordinate of a point whose density in a triangle is
/// that coordinate. Inverse of 3 x^2 - 2 x^3.
LUCERNA_HD inline double inverse_smoothstep(double u) {
  return 0.5 - std::sin(std::asin(1.0 - 2.0 * u) / 3.0);
}

/// The flat arrays that ClusterModel draws rays from, on the CPU or copied to a GPU. Points into them.
struct ClusterView {
  const MeshPiece* pieces = nullptr;
  const Triangle* elements = nullptr;
  const Vec3* points = nullptr;
  /// Alias table of the pieces' corners, three a piece.
  const float* piece_probability = nullptr;
  const std::uint32_t* piece_alias = nullptr;
  /// Leaves of cluster v are leaf_begin[v] .. leaf_begin[v + 1] - 1, with an alias table each.
  const std::uint32_t* leaf_begin = nullptr;
  const float* leaf_probability = nullptr;
  const std::uint32_t* leaf_alias = nullptr;
  const std::uint32_t* leaf_triangle = nullptr;
  const SphericalTriangleSampler* triangles = nullptr;
  std::size_t piece_count = 0, element_count = 0, cluster_count = 0, leaf_count = 0, triangle_count = 0;
  MeshSurface surface;
};

/// The corner of an element that is nearest to a point.
LUCERNA_HD inline std::uint32_t nearest_cluster(const Triangle& element, const Vec3* points,
                                                const Vec3& point_mm) {
  std::uint32_t best = element[0];
  double nearest = 1e300;
  for (const std::uint32_t v : element) {
    const Vec3 d = points[v] - point_mm;
    if (dot(d, d) < nearest) {
      nearest = dot(d, d);
      best = v;
    }
  }
  return best;
}

/// Ray of the point `u` of the unit cube: ClusterModel::sample.
LUCERNA_HD inline Ray sample_clusters(const ClusterView& v, const std::array<double, 6>& u) {
  const std::uint32_t item = alias_pick(v.piece_probability, v.piece_alias, 3 * v.piece_count, u[0]);
  const MeshPiece& piece = v.pieces[item / 3];
  const Triangle& element = v.elements[piece.element];
  const std::size_t k = item % 3;
  const Vec3 &a = piece.corner_mm[k], &b = piece.corner_mm[(k + 1) % 3], &c = piece.corner_mm[(k + 2) % 3];
  Vec3 p = a;
  switch (mesh_corners(element)) {
    case 3: {
      const double own = inverse_smoothstep(u[1]), rest = 1.0 - own;
      p = own * a + (rest * u[2]) * b + (rest * (1.0 - u[2])) * c;
      break;
    }
    case 2: {
      const double own = std::sqrt(u[1]);
      p = own * a + (1.0 - own) * (k == 0 ? b : c);
      break;
    }
    default:
      break;
  }
  p = v.surface.put_back(p);
  const std::uint32_t cluster = nearest_cluster(element, v.points, p);
  const std::size_t first = v.leaf_begin[cluster], n = v.leaf_begin[cluster + 1] - first;
  const std::size_t leaf = first + alias_pick(v.leaf_probability + first, v.leaf_alias + first, n, u[3]);
  return {p, v.triangles[v.leaf_triangle[leaf]].sample(u[4], u[5])};
}

}  // namespace lucerna
