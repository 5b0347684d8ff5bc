// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"

namespace lucerna {

// The first hit of a ray with a tree over triangles, one ray at a time; small functions that CPU and GPU
// share. Boxes are looked at in float and err on the safe side, triangles in double.

/// A box about consecutive triangles. Nodes stand in depth-first order: a ray that misses a box goes on at
/// `skip`, else at the next node.
struct alignas(16) TriangleNode {
  float low[3], high[3];
  std::int32_t skip;
  /// Of a leaf: its first triangle times kLeafCounts, and their number; 0 inside the tree.
  std::uint32_t leaf;
};
inline constexpr std::uint32_t kLeafCounts = 8;

/// Corners, the body it belongs to and its number there.
struct TreeTriangle {
  float corner[3][3];
  std::uint32_t body, number;
};

struct TriangleBvhView {
  const TriangleNode* nodes = nullptr;
  const TreeTriangle* triangles = nullptr;
  std::int32_t node_count = 0;
};

struct TriangleHit {
  std::int32_t triangle = -1;  ///< none
  double t = 0.0;
  double u = 0.0, v = 0.0;  ///< weights of the second and third corner
};

LUCERNA_HD inline Vec3 corner_of(const TreeTriangle& k, int i) {
  return {static_cast<double>(k.corner[i][0]), static_cast<double>(k.corner[i][1]),
          static_cast<double>(k.corner[i][2])};
}
/// Its length is twice the area.
LUCERNA_HD inline Vec3 normal_of(const TreeTriangle& k) {
  const Vec3 a = corner_of(k, 0);
  return cross(corner_of(k, 1) - a, corner_of(k, 2) - a);
}

/// A ray as boxes are tested with it.
struct BvhRay {
  float o[3], inverse[3];
  LUCERNA_HD BvhRay(const Vec3& origin, const Vec3& d) {
    const double from[3] = {origin.x, origin.y, origin.z}, along[3] = {d.x, d.y, d.z};
    for (int i = 0; i < 3; ++i) {
      o[i] = static_cast<float>(from[i]);
      // A component that is nearly 0 counts as tiny, so that nothing is infinite.
      const double step = std::fabs(along[i]) < 1e-18 ? std::copysign(1e-18, along[i]) : along[i];
      inverse[i] = static_cast<float>(1.0 / step);
    }
  }
  /// True if the ray is surely not in the box within [0, t_max].
  LUCERNA_HD bool misses(const TriangleNode& n, float t_max) const {
    float near = 0.0F, far = t_max;
    for (int i = 0; i < 3; ++i) {
      const float a = (n.low[i] - o[i]) * inverse[i], b = (n.high[i] - o[i]) * inverse[i];
      const float in = a < b ? a : b, out = a < b ? b : a;
      near = in > near ? in : near;
      far = out < far ? out : far;
    }
    // Both are right to 3 roundings (T. Ize, "Robust BVH ray traversal", JCGT 2(2), 2013).
    return near > far * 1.000001F;
  }
};

/// Moves `best` to triangle number `i` if the ray hits it in (t_min, best.t). Which side of an edge the ray
/// passes on is told from the edge's ends alone, and exactly opposite for the triangle beyond it: a ray
/// cannot pass between two triangles that share their corners.
LUCERNA_HD inline void intersect_triangle(const TreeTriangle& k, std::int32_t i, const Vec3& o, const Vec3& d,
                                          double t_min, TriangleHit& best) {
  const Vec3 a = corner_of(k, 0) - o, b = corner_of(k, 1) - o, c = corner_of(k, 2) - o;
  const double u = dot(cross(c, b), d), v = dot(cross(a, c), d), w = dot(cross(b, a), d);
  const bool some_below = u < 0.0 || v < 0.0 || w<0.0, some_above = u> 0.0 || v > 0.0 || w > 0.0;
  if (some_below == some_above) return;  // outside, or in its plane
  const Vec3 n = normal_of(k);
  const double t = dot(n, a) / dot(n, d);
  if (!(t > t_min && t < best.t)) return;
  const double all = u + v + w;
  best = {i, t, v / all, w / all};
}

/// The first triangle in (t_min, t_max).
LUCERNA_HD inline TriangleHit first_triangle(const TriangleBvhView& tree, const Vec3& o, const Vec3& d,
                                             double t_min, double t_max) {
  TriangleHit best;
  best.t = t_max;
  const BvhRay ray(o, d);
  for (std::int32_t i = 0; i < tree.node_count;) {
    const TriangleNode node = tree.nodes[i];
    if (ray.misses(node, static_cast<float>(best.t) * 1.000001F)) {
      i = node.skip;
      continue;
    }
    const std::int32_t first = static_cast<std::int32_t>(node.leaf / kLeafCounts);
    const std::int32_t end = first + static_cast<std::int32_t>(node.leaf % kLeafCounts);
    for (std::int32_t k = first; k < end; ++k) intersect_triangle(tree.triangles[k], k, o, d, t_min, best);
    ++i;
  }
  return best;
}

}  // namespace lucerna
