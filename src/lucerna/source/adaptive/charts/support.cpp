// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/support.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/charts/support_ray.h"

namespace lucerna {

namespace {

using namespace detail;

constexpr double kUnbounded = 1e30;
constexpr std::array<std::string_view, kSupportKinds> kSupportNames{"plane", "sphere", "cylinder", "box",
                                                                    "focal", "axis",   "disk"};

using Pair = std::array<double, 2>;

double azimuth_of(double x, double y) { return x == 0.0 && y == 0.0 ? 0.0 : std::atan2(y, x); }

double wrapped(double angle) {
  const double turns = std::floor((angle + kPi) / (2.0 * kPi));
  return std::clamp(angle - 2.0 * kPi * turns, -kPi, kPi);
}

/// The inverse of warp::disk, in [0, 1].
Pair square_from_disk(double x, double y) {
  const double r = std::sqrt(x * x + y * y);
  if (r == 0.0) return {0.5, 0.5};
  constexpr double k = 4.0 / kPi;
  if (std::abs(x) >= std::abs(y)) {
    const double a = x > 0.0 ? r : -r;
    return {0.5 * (a + 1.0), 0.5 * (a * k * std::atan(y / x) + 1.0)};
  }
  const double b = y > 0.0 ? r : -r;
  return {0.5 * (b * k * std::atan(x / y) + 1.0), 0.5 * (b + 1.0)};
}

Pair projected_from(const Vec3& d, const OrthonormalBasis& t, PolarMap map) {
  const double x = dot(d, t.u), y = dot(d, t.v);
  if (map == PolarMap::polar) return {std::min(0.5, 0.5 * (x * x + y * y)), azimuth_of(x, y)};
  const Pair s = square_from_disk(x, y);
  return {kSquare * s[0], kSquare * s[1]};
}

ChartPoint with_direction(std::uint32_t chart, double c0, double c1, const Vec3& d, const OrthonormalBasis& t,
                          PolarMap map) {
  const Pair p = projected_from(d, t, map);
  return {chart, {c0, c1, p[0], p[1]}};
}

std::optional<ChartPoint> plane_chart(const Ray& r, PolarMap map, bool round) {
  const double dz = r.direction.z();
  if (std::abs(dz) < kGrazing) return std::nullopt;
  const Vec3 p = r.at(-r.origin_mm.z / dz);
  const std::uint32_t chart = dz > 0.0 ? 0 : 1;
  const double across = 0.5 * (p.x * p.x + p.y * p.y);
  if (round)
    return with_direction(chart, across, azimuth_of(p.x, p.y), r.direction, disk_basis(p, chart), map);
  return with_direction(chart, p.x, p.y, r.direction, plane_basis(chart), map);
}

std::optional<ChartPoint> sphere_chart(const Ray& r, double radius, PolarMap map) {
  const double along = dot(r.origin_mm, r.direction.vec());
  const Vec3 q = r.origin_mm - along * r.direction.vec();
  const double rest = radius * radius - dot(q, q);
  if (rest < 0.0) return std::nullopt;
  const Direction n = Direction::from(q + std::sqrt(rest) * r.direction.vec());
  return with_direction(0, radius * n.z(), radius * azimuth_of(n.x(), n.y()), r.direction,
                        sphere_basis(n.vec()), map);
}

std::optional<ChartPoint> cylinder_chart(const Ray& r, const Support& s) {
  BoundingSurface body{SurfaceKind::cylinder, {}, s.radius_mm, s.half_size_mm};
  const auto t = body.exit_distance_mm(r);
  if (!t) return std::nullopt;
  const Vec3 p = r.at(*t);
  const double rho = std::hypot(p.x, p.y), azimuth = azimuth_of(p.x, p.y);
  // Beside the rim both faces are near; the one that the ray crosses is the one it has just reached.
  const bool cap = s.half_size_mm.z - std::abs(p.z) < s.radius_mm - rho;
  if (cap) {
    const std::uint32_t chart = p.z > 0.0 ? 1 : 2;
    return with_direction(chart, 0.5 * rho * rho, azimuth, r.direction, plane_basis(chart - 1), s.map);
  }
  return with_direction(0, s.radius_mm * wrapped(azimuth - s.twist_per_mm * p.z), p.z, r.direction,
                        lateral_basis(azimuth), s.map);
}

std::optional<ChartPoint> box_chart(const Ray& r, const Support& s) {
  BoundingSurface body{SurfaceKind::box, {}, 0.0, s.half_size_mm};
  const auto t = body.exit_distance_mm(r);
  if (!t) return std::nullopt;
  const Vec3 p = r.at(*t);
  std::size_t axis = 0;
  double nearest = kUnbounded;
  for (std::size_t a = 0; a < 3; ++a) {
    const double gap = std::abs(component(s.half_size_mm, a) - std::abs(component(p, a)));
    if (component(p, a) * component(r.direction, a) > 0.0 && gap < nearest) nearest = gap, axis = a;
  }
  const auto chart = static_cast<std::uint32_t>(2 * axis + (component(p, axis) > 0.0 ? 0 : 1));
  return with_direction(chart, component(p, (axis + 1) % 3), component(p, (axis + 2) % 3), r.direction,
                        box_basis(chart), s.map);
}

std::optional<ChartPoint> focal_chart(const Ray& r, PolarMap map) {
  const Vec3& d = r.direction.vec();
  const Vec3 p = r.origin_mm - dot(r.origin_mm, d) * d;
  const OrthonormalBasis t = sphere_basis(d);
  const double x = dot(p, t.v), y = dot(p, t.u), azimuth = azimuth_of(d.x, d.y);
  if (map == PolarMap::polar) return ChartPoint{0, {0.5 * (x * x + y * y), azimuth_of(x, y), d.z, azimuth}};
  return ChartPoint{0, {x, y, d.z, azimuth}};
}

std::optional<ChartPoint> axis_chart(const Ray& r, double twist) {
  const Vec3& d = r.direction.vec();
  const double across = std::hypot(d.x, d.y);
  if (across < kGrazing) return std::nullopt;
  const double c = d.x / across, s = d.y / across;
  const double t = -(r.origin_mm.x * c + r.origin_mm.y * s) / across;
  const double z = r.origin_mm.z + t * d.z, b = r.origin_mm.y * c - r.origin_mm.x * s;
  const double angle = std::atan2(across, d.z);
  return ChartPoint{0, {z, b, 0.5 * (angle - across * d.z), wrapped(std::atan2(d.y, d.x) - twist * z)}};
}

std::array<double, 2> position_range(const Support& s, std::uint32_t chart, std::size_t d) {
  switch (s.kind) {
    case SupportKind::sphere:
      if (d == 0) return {-s.radius_mm, s.radius_mm};
      return {-kPi * s.radius_mm, kPi * s.radius_mm};
    case SupportKind::cylinder:
      if (chart == 0 && d == 0) return {-kPi * s.radius_mm, kPi * s.radius_mm};
      if (chart == 0) return {-s.half_size_mm.z, s.half_size_mm.z};
      if (d == 0) return {0.0, 0.5 * s.radius_mm * s.radius_mm};
      return {-kPi, kPi};
    case SupportKind::box: {
      const double half = component(s.half_size_mm, (chart / 2 + 1 + d) % 3);
      return {-half, half};
    }
    case SupportKind::focal:
      if (s.map == PolarMap::polar && d == 0) return {0.0, kUnbounded};
      if (s.map == PolarMap::polar) return {-kPi, kPi};
      break;
    case SupportKind::disk:
      if (d == 0) return {0.0, kUnbounded};
      return {-kPi, kPi};
    case SupportKind::plane:
    case SupportKind::axis:
      break;
  }
  return {-kUnbounded, kUnbounded};
}

}  // namespace

std::string_view to_string(SupportKind kind) { return kSupportNames[static_cast<std::size_t>(kind)]; }

std::uint32_t Support::charts() const {
  constexpr std::array<std::uint32_t, kSupportKinds> kCharts{2, 1, 3, 6, 1, 1, 2};
  return kCharts[static_cast<std::size_t>(kind)];
}

std::array<double, 2> Support::range(std::uint32_t chart, std::size_t d) const {
  if (d < 2) return position_range(*this, chart, d);
  if (kind == SupportKind::focal && d == 2) return {-1.0, 1.0};
  if (kind == SupportKind::axis && d == 2) return {0.0, 0.5 * kPi};
  if (kind == SupportKind::focal || kind == SupportKind::axis) return {-kPi, kPi};
  if (map == PolarMap::concentric) return {0.0, kSquare};
  if (d == 2) return {0.0, 0.5};
  return {-kPi, kPi};
}

std::optional<ChartPoint> Support::to_chart(const Ray& outside) const {
  Ray world = outside;
  if (dome.exists()) {
    const auto inside = dome.inside(outside);
    if (!inside) return std::nullopt;
    world = *inside;
  }
  const Frame& f = world_from_support;
  const Vec3 o = world.origin_mm - f.origin_mm();
  const Vec3& d = world.direction.vec();
  const Ray r{{dot(o, f.ex()), dot(o, f.ey()), dot(o, f.ez())},
              Direction::from_unit({dot(d, f.ex()), dot(d, f.ey()), dot(d, f.ez())})};
  switch (kind) {
    case SupportKind::plane:
    case SupportKind::disk:
      return plane_chart(r, map, kind == SupportKind::disk);
    case SupportKind::sphere:
      return sphere_chart(r, radius_mm, map);
    case SupportKind::cylinder:
      return cylinder_chart(r, *this);
    case SupportKind::box:
      return box_chart(r, *this);
    case SupportKind::focal:
      return focal_chart(r, map);
    case SupportKind::axis:
      return axis_chart(r, twist_per_mm);
  }
  return std::nullopt;
}

Ray Support::from_chart(const ChartPoint& p) const { return ray_from_chart(*this, p); }

std::optional<Support> support_on(const BoundingSurface& surface, PolarMap map) {
  Support s;
  s.map = map;
  s.world_from_support = surface.world_from_surface;
  switch (surface.kind) {
    case SurfaceKind::none:
      return std::nullopt;
    case SurfaceKind::plane:
      s.kind = SupportKind::plane;
      return s;
    case SurfaceKind::sphere:
      s.kind = SupportKind::sphere;
      s.radius_mm = surface.radius_mm;
      return s;
    case SurfaceKind::cylinder:
      s.kind = SupportKind::cylinder;
      s.radius_mm = surface.radius_mm;
      s.half_size_mm = surface.half_size_mm;
      return s;
    case SurfaceKind::box:
      s.kind = SupportKind::box;
      s.half_size_mm = surface.half_size_mm;
      return s;
  }
  return std::nullopt;
}

Ray start_on(const BoundingSurface& surface, const Ray& ray) {
  const auto placed = placed_on(surface, ray);
  LUCERNA_CHECK(placed.has_value(), "a line through the centre misses its {} surface",
                to_string(surface.kind));
  return *placed;
}

}  // namespace lucerna
