// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/keep_out.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>

namespace lucerna {

namespace {

/// Places across an aperture; a zone is seen on so many at most.
constexpr int kColumnsAcross = 80;
/// Points of a zone are at most half a place apart, but no more than this many a triangle's side.
constexpr double kMaxParts = 400.0;

/// Distances along a row of places, for fixed columns.
struct Lattice {
  double step;
  int place(double mm) const { return static_cast<int>(std::lround(mm / step)); }
};

/// The point of an aperture next to a place, its rims included.
std::array<double, 2> onto(const Aperture& a, double x, double y) {
  if (a.contains(x, y)) return {x, y};
  const double r = std::hypot(x, y), hole = a.hole_radius_mm();
  if (r < hole)
    return r > 0.0 ? std::array<double, 2>{x * hole / r, y * hole / r} : std::array<double, 2>{hole, 0.0};
  if (a.shape() == ApertureShape::circle) return {x * a.half_x_mm() / r, y * a.half_x_mm() / r};
  return {std::clamp(x, -a.half_x_mm(), a.half_x_mm()), std::clamp(y, -a.half_y_mm(), a.half_y_mm())};
}

}  // namespace

std::vector<Vec3> surface_points(const Mesh& mesh, double spacing_mm) {
  std::vector<Vec3> points;
  for (const auto& t : mesh.triangles) {
    const Vec3 &a = mesh.vertices_mm[t[0]], &b = mesh.vertices_mm[t[1]], &c = mesh.vertices_mm[t[2]];
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    const int n = static_cast<int>(std::clamp(std::ceil(longest / spacing_mm), 1.0, kMaxParts));
    for (int i = 0; i <= n; ++i) {
      for (int k = 0; i + k <= n; ++k) {
        const double u = static_cast<double>(i) / n, v = static_cast<double>(k) / n;
        points.push_back(a + u * (b - a) + v * (c - a));
      }
    }
  }
  return points;
}

std::vector<ZoneColumn> zone_columns(const KeepOut& zone, const Aperture& aperture, bool revolution) {
  const double outer = aperture.outer_radius_mm(), step = 2.0 * outer / kColumnsAcross;
  const Lattice lattice{step};
  // A point represents all within half a step of it, so that nothing slips between the places.
  const double reach = zone.clearance_mm + step;
  const int cells = static_cast<int>(std::ceil(reach / step));
  std::unordered_map<long long, ZoneColumn> columns;
  const auto take = [&](int i, int j, const Vec3& p, double px, double py) {
    const auto [x, y] = onto(aperture, i * step, j * step);
    if (std::hypot(x - i * step, y - j * step) > 1.5 * step) return;
    const double d = std::max(0.0, std::hypot(px - x, py - y) - step);
    if (d > zone.clearance_mm) return;
    const double half = std::sqrt(zone.clearance_mm * zone.clearance_mm - d * d);
    const long long key = static_cast<long long>(i) * 1000003LL + j;
    const auto [at, fresh] = columns.try_emplace(key, ZoneColumn{x, y, p.z - half, p.z + half});
    if (fresh) return;
    at->second.low_mm = std::min(at->second.low_mm, p.z - half);
    at->second.high_mm = std::max(at->second.high_mm, p.z + half);
  };
  for (const Vec3& p : surface_points(zone.mesh, 0.5 * step)) {
    const double x = revolution ? std::hypot(p.x, p.y) : p.x, y = revolution ? 0.0 : p.y;
    if (std::hypot(x, y) > outer + reach) continue;
    const int ci = lattice.place(x), cj = lattice.place(y);
    for (int j = revolution ? 0 : -cells; j <= (revolution ? 0 : cells); ++j) {
      for (int i = -cells; i <= cells; ++i) {
        if (revolution && ci + i < 0) continue;
        take(ci + i, cj + j, p, x, y);
      }
    }
  }
  std::vector<ZoneColumn> out;
  for (const auto& [key, column] : columns) out.push_back(column);
  std::sort(out.begin(), out.end(), [](const ZoneColumn& a, const ZoneColumn& b) {
    return a.y_mm != b.y_mm ? a.y_mm < b.y_mm : a.x_mm < b.x_mm;
  });
  return out;
}

}  // namespace lucerna
