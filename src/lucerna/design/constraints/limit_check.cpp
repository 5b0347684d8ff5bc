// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/constraints/limit_check.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "lucerna/core/io/error.h"
#include "lucerna/design/constraints/keep_out.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/mesh/mesh_curvature.h"

namespace lucerna {

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// What the triangles say about a mirror.
struct Figures {
  double widest = 0.0, hole = kFar, low = kFar, high = -kFar, max_slope = 0.0;
  double half_x = 0.0, half_y = 0.0;
};

/// Distance of a segment from the z axis.
double from_axis(const Vec3& a, const Vec3& b) {
  const double dx = b.x - a.x, dy = b.y - a.y, square = dx * dx + dy * dy;
  const double t = square > 0.0 ? std::clamp(-(a.x * dx + a.y * dy) / square, 0.0, 1.0) : 0.0;
  return std::hypot(a.x + t * dx, a.y + t * dy);
}

/// True if the z axis goes through a triangle.
bool on_axis(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double u = a.x * b.y - a.y * b.x, v = b.x * c.y - b.y * c.x, w = c.x * a.y - c.y * a.x;
  return (u >= 0.0 && v >= 0.0 && w >= 0.0) || (u <= 0.0 && v <= 0.0 && w <= 0.0);
}

Figures figures(const Mesh& mesh) {
  Figures f;
  for (const auto& t : mesh.triangles) {
    const std::array<Vec3, 3> p{mesh.vertices_mm[t[0]], mesh.vertices_mm[t[1]], mesh.vertices_mm[t[2]]};
    const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
    f.max_slope = std::max(f.max_slope, std::atan2(std::hypot(normal.x, normal.y), normal.z));
    if (on_axis(p[0], p[1], p[2])) f.hole = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      f.hole = std::min(f.hole, from_axis(p[k], p[(k + 1) % 3]));
      f.widest = std::max(f.widest, std::hypot(p[k].x, p[k].y));
      f.half_x = std::max(f.half_x, std::abs(p[k].x));
      f.half_y = std::max(f.half_y, std::abs(p[k].y));
      f.low = std::min(f.low, p[k].z);
      f.high = std::max(f.high, p[k].z);
    }
  }
  return f;
}

/// Points in cells, to find near ones.
class Near {
 public:
  Near(const std::vector<Vec3>& points, double reach) : points_(points), reach_(reach) {
    for (std::size_t i = 0; i < points.size(); ++i) cells_[key(cell(points[i]))].push_back(i);
  }
  /// Distance to the nearest point, or the reach if none is nearer.
  double distance(const Vec3& p) const {
    const auto [x, y, z] = cell(p);
    double min = reach_;
    for (long k = -1; k <= 1; ++k) {
      for (long j = -1; j <= 1; ++j) {
        for (long i = -1; i <= 1; ++i) {
          const auto found = cells_.find(key({x + i, y + j, z + k}));
          if (found == cells_.end()) continue;
          for (const std::size_t n : found->second) min = std::min(min, length(points_[n] - p));
        }
      }
    }
    return min;
  }

 private:
  std::array<long, 3> cell(const Vec3& p) const {
    return {std::lround(p.x / reach_), std::lround(p.y / reach_), std::lround(p.z / reach_)};
  }
  static long key(const std::array<long, 3>& c) {
    return (c[0] * 73856093L) ^ (c[1] * 19349663L) ^ (c[2] * 83492791L);
  }
  const std::vector<Vec3>& points_;
  double reach_;
  std::unordered_map<long, std::vector<std::size_t>> cells_;
};

/// True if a point is inside a closed mesh: its line along +z leaves more often than it enters, by parity.
bool inside(const Mesh& mesh, const Vec3& p) {
  bool in = false;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.vertices_mm[t[0]] - p, b = mesh.vertices_mm[t[1]] - p, c = mesh.vertices_mm[t[2]] - p;
    const double u = b.x * c.y - b.y * c.x, v = c.x * a.y - c.y * a.x, w = a.x * b.y - a.y * b.x;
    const bool over = (u > 0.0 && v > 0.0 && w > 0.0) || (u < 0.0 && v < 0.0 && w < 0.0);
    if (over && (u * a.z + v * b.z + w * c.z) / (u + v + w) > 0.0) in = !in;
  }
  return in;
}

double distance_to(const Mesh& mirror, const KeepOut& zone) {
  const double reach = zone.clearance_mm + 1.0;
  Vec3 low{kFar, kFar, kFar}, high{-kFar, -kFar, -kFar};
  for (const Vec3& v : zone.mesh.vertices_mm) {
    low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
    high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
  }
  const std::vector<Vec3> points = surface_points(zone.mesh, 0.25 * std::max(reach, 1.0));
  const Near near(points, reach);
  double min = reach;
  for (const auto& t : mirror.triangles) {
    const Vec3 &a = mirror.vertices_mm[t[0]], &b = mirror.vertices_mm[t[1]], &c = mirror.vertices_mm[t[2]];
    for (const Vec3& p : {a, b, c, (a + b + c) / 3.0}) {
      if (p.x < low.x - reach || p.y < low.y - reach || p.z < low.z - reach) continue;
      if (p.x > high.x + reach || p.y > high.y + reach || p.z > high.z + reach) continue;
      min = std::min(min, near.distance(p));
      const bool boxed =
          p.x > low.x && p.y > low.y && p.z > low.z && p.x < high.x && p.y < high.y && p.z < high.z;
      if (boxed && inside(zone.mesh, p)) return 0.0;
    }
  }
  return min;
}

}  // namespace

std::vector<LimitCheck> check_limits(const Mesh& mirror, const DesignLimits& limits, double chord_mm,
                                     double slope_deg) {
  const Figures f = figures(mirror);
  std::vector<LimitCheck> out;
  const auto max = [&](const char* name, const std::optional<double>& allowed, double found, double within) {
    if (allowed) out.push_back({name, *allowed, {found, 0.0}, found <= *allowed + within});
  };
  const auto min = [&](const char* name, const std::optional<double>& allowed, double found, double within) {
    if (allowed) out.push_back({name, *allowed, {found, 0.0}, found >= *allowed - within});
  };
  max("max_diameter_mm", limits.max_diameter_mm, 2.0 * f.widest, 1e-4);
  min("min_opening_mm", limits.min_opening_mm, 2.0 * std::min(f.half_x, f.half_y), 2.0 * chord_mm);
  min("min_hole_diameter_mm", limits.min_hole_diameter_mm, 2.0 * f.hole, 2.0 * chord_mm);
  max("max_height_mm", limits.max_height_mm, f.high - f.low, 1e-4);
  max("max_slope_deg", limits.max_slope_deg, degrees(f.max_slope), slope_deg);
  if (limits.min_radius_mm) {
    const double radius = 1.0 / std::max(max_curvature_per_mm(mirror), 1e-9);
    min("min_radius_mm", limits.min_radius_mm, radius, 0.01 * *limits.min_radius_mm);
  }
  for (const KeepOut& zone : limits.keep_out) {
    const double distance = distance_to(mirror, zone);
    out.push_back({zone.name,
                   zone.clearance_mm,
                   {distance, 0.0},
                   distance > 0.0 && distance >= zone.clearance_mm - 2.0 * chord_mm});
  }
  return out;
}

std::string binding_limits(const std::vector<LimitCheck>& checks) {
  std::string names;
  for (const LimitCheck& c : checks) {
    const std::string key = c.limit.substr(0, c.limit.find(' '));
    if (key == "max_diameter_mm" || key == "min_opening_mm" || key == "min_hole_diameter_mm") continue;
    const bool zone = key == "body" || key.rfind("keep_out", 0) == 0;
    const double near = zone ? 0.2 : 0.05 * std::abs(c.allowed);
    if (std::abs(c.found.mean - c.allowed) > near && c.held) continue;
    const char* what = key == "min_efficiency"          ? "efficiency"
                       : key == "glare"                 ? "glare"
                       : key == "max_height_mm" || zone ? "envelope"
                                                        : "tooling";
    names += fmt::format("{}{} ({}: {} found, {:.4g} allowed)", names.empty() ? "" : ", ", what, c.limit,
                         estimate_text(c.found), c.allowed);
  }
  return names.empty() ? names : "what limits this design is set: " + names;
}

std::vector<std::string> broken_limits(const std::vector<LimitCheck>& checks) {
  std::vector<std::string> out;
  for (const LimitCheck& c : checks) {
    if (c.held) continue;
    out.push_back(fmt::format("limit {} is not held: {} found, {:.4g} allowed", c.limit,
                              estimate_text(c.found), c.allowed));
  }
  return out;
}

}  // namespace lucerna
