// SPDX-License-Identifier: Apache-2.0
#include "surface.h"

#include <algorithm>
#include <limits>

namespace bench {

namespace {

double segment_distance(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double square = dot(along, along);
  const double t = square > 0.0 ? std::clamp(dot(p - a, along) / square, 0.0, 1.0) : 0.0;
  return length(p - (a + t * along));
}

double triangle_distance(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
  const Vec3 n = unit(cross(b - a, c - a));
  const auto left_of = [&](const Vec3& from, const Vec3& to) {
    return dot(cross(to - from, p - from), n) >= 0.0;
  };
  // A triangle without area, as at the pole of a surface of revolution, has its sides only.
  const bool flat = dot(n, n) > 0.0;
  if (flat && left_of(a, b) && left_of(b, c) && left_of(c, a)) return std::abs(dot(p - a, n));
  return std::min({segment_distance(p, a, b), segment_distance(p, b, c), segment_distance(p, c, a)});
}

}  // namespace

double distance(const Surface& surface, const Vec3& from) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const Vec3& p : surface.extent()) nearest = std::min(nearest, length(p - from));
  const auto& c = surface.triangles().corners;
  for (const auto& t : surface.triangles().triangles) {
    if (surface.whole(t)) nearest = std::min(nearest, triangle_distance(from, c[t[0]], c[t[1]], c[t[2]]));
  }
  return nearest;
}

}  // namespace bench
