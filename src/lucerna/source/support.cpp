// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/support.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/error.h"
#include "lucerna/source/warp.h"

namespace lucerna {

namespace {

constexpr double kPi = std::numbers::pi, kUnbounded = 1e30;
/// Lines flatter than this to a plane, or to the axis of an axis support, have no usable coordinates there.
constexpr double kGrazing = 1e-6;

constexpr std::array<std::string_view, kSupportKinds> kNames{"plane", "sphere", "cylinder", "box",
                                                             "focal", "axis",   "disk"};

using Pair = std::array<double, 2>;

/// A right-handed triad at a point of a surface.
struct Triad {
  Vec3 u, v, n;
};

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

/// Scale of the concentric square: its area is the projected solid angle of the hemisphere, pi.
const double kSquare = std::sqrt(kPi);

Pair projected_from(const Vec3& d, const Triad& t, PolarMap map) {
  const double x = dot(d, t.u), y = dot(d, t.v);
  if (map == PolarMap::polar) return {std::min(0.5, 0.5 * (x * x + y * y)), azimuth_of(x, y)};
  const Pair s = square_from_disk(x, y);
  return {kSquare * s[0], kSquare * s[1]};
}

Direction direction_from(double a, double b, const Triad& t, PolarMap map) {
  double x, y;
  if (map == PolarMap::polar) {
    const double r = std::sqrt(std::clamp(2.0 * a, 0.0, 1.0));
    x = r * std::cos(b), y = r * std::sin(b);
  } else {
    const Vec3 p = warp::disk(std::clamp(a / kSquare, 0.0, 1.0), std::clamp(b / kSquare, 0.0, 1.0));
    x = p.x, y = p.y;
  }
  const double z = std::sqrt(std::max(0.0, 1.0 - x * x - y * y));
  return Direction::from_unit(x * t.u + y * t.v + z * t.n);
}

/// Solves t - sin t = m for 0 <= m <= 2 pi: the start is the series in (6 m)^(1/3), then Newton's method.
double solve_t_minus_sin(double m) {
  const bool upper = m > kPi;
  const double half = upper ? 2.0 * kPi - m : m;
  if (half <= 0.0) return upper ? 2.0 * kPi : 0.0;
  const double s = std::cbrt(6.0 * half), s2 = s * s;
  double t = s * (1.0 + s2 * (1.0 / 60.0 + s2 * (1.0 / 1400.0 + s2 / 25200.0)));
  for (int i = 0; i < 3; ++i) {
    const double slope = 1.0 - std::cos(t);
    if (slope < 1e-14) break;
    t -= (t - std::sin(t) - half) / slope;
  }
  return upper ? 2.0 * kPi - t : t;
}

/// Charts of a plane: 0 to +z, 1 to -z (mirrored, so that the triad stays right-handed).
Triad plane_triad(std::uint32_t chart) {
  if (chart == 0) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
}

/// On a disk azimuths of directions count from the radius, so that round sources look the same all round.
Triad disk_triad(const Vec3& p, std::uint32_t chart) {
  const double r = std::hypot(p.x, p.y), c = r > 0.0 ? p.x / r : 1.0, s = r > 0.0 ? p.y / r : 0.0;
  if (chart == 0) return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  return {{c, s, 0}, {s, -c, 0}, {0, 0, -1}};
}

Vec3 unit_axis(std::size_t axis, double sign) {
  return {axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0};
}

double component(const Vec3& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

Triad box_triad(std::uint32_t chart) {
  const std::size_t axis = chart / 2;
  const double sign = chart % 2 == 0 ? 1.0 : -1.0;
  return {unit_axis((axis + 1) % 3, 1.0), unit_axis((axis + 2) % 3, sign), unit_axis(axis, sign)};
}

Triad mantle_triad(double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  return {{-s, c, 0}, {0, 0, 1}, {c, s, 0}};
}

Triad sphere_triad(const Vec3& n) {
  const double across = std::hypot(n.x, n.y);
  const double c = across > 0.0 ? n.x / across : 1.0, s = across > 0.0 ? n.y / across : 0.0;
  return {{-s, c, 0}, {-n.z * c, -n.z * s, across}, n};
}

ChartPoint with_direction(std::uint32_t chart, double c0, double c1, const Vec3& d, const Triad& t,
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
    return with_direction(chart, across, azimuth_of(p.x, p.y), r.direction, disk_triad(p, chart), map);
  return with_direction(chart, p.x, p.y, r.direction, plane_triad(chart), map);
}

std::optional<ChartPoint> sphere_chart(const Ray& r, double radius, PolarMap map) {
  const double along = dot(r.origin_mm, r.direction.vec());
  const Vec3 q = r.origin_mm - along * r.direction.vec();
  const double rest = radius * radius - dot(q, q);
  if (rest < 0.0) return std::nullopt;
  const Direction n = Direction::from(q + std::sqrt(rest) * r.direction.vec());
  return with_direction(0, radius * n.z(), radius * azimuth_of(n.x(), n.y()), r.direction,
                        sphere_triad(n.vec()), map);
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
    return with_direction(chart, 0.5 * rho * rho, azimuth, r.direction, plane_triad(chart - 1), s.map);
  }
  return with_direction(0, s.radius_mm * wrapped(azimuth - s.twist_per_mm * p.z), p.z, r.direction,
                        mantle_triad(azimuth), s.map);
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
                        box_triad(chart), s.map);
}

std::optional<ChartPoint> focal_chart(const Ray& r, PolarMap map) {
  const Vec3& d = r.direction.vec();
  const Vec3 p = r.origin_mm - dot(r.origin_mm, d) * d;
  const Triad t = sphere_triad(d);
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

Ray axis_ray(const std::array<double, 4>& c, double twist) {
  const double angle = 0.5 * solve_t_minus_sin(std::clamp(4.0 * c[2], 0.0, 2.0 * kPi));
  const double azimuth = c[3] + twist * c[0];
  const double x = std::cos(azimuth), y = std::sin(azimuth), across = std::sin(angle);
  return {{-c[1] * y, c[1] * x, c[0]}, Direction::from_unit({across * x, across * y, std::cos(angle)})};
}

Ray focal_ray(const std::array<double, 4>& c, PolarMap map) {
  const Direction d = warp::at_cosine(std::clamp(c[2], -1.0, 1.0), c[3] / (2.0 * kPi));
  const double cosine = std::cos(c[3]), sine = std::sin(c[3]);
  const double across = std::sqrt(std::max(0.0, 1.0 - d.z() * d.z()));
  const Vec3 u{-sine, cosine, 0}, v{-d.z() * cosine, -d.z() * sine, across};
  double x = c[0], y = c[1];
  if (map == PolarMap::polar) {
    const double p = std::sqrt(std::max(0.0, 2.0 * c[0]));
    x = p * std::cos(c[1]), y = p * std::sin(c[1]);
  }
  return {x * v + y * u, d};
}

Ray sphere_ray(const std::array<double, 4>& c, double radius, PolarMap map) {
  const double z = std::clamp(c[0] / radius, -1.0, 1.0);
  const Direction n = warp::at_cosine(z, c[1] / (2.0 * kPi * radius));
  // At the poles the triad follows the azimuth that was stored, not the one left in n.
  const double cosine = std::cos(c[1] / radius), sine = std::sin(c[1] / radius);
  const Triad t{{-sine, cosine, 0}, {-z * cosine, -z * sine, std::sqrt(std::max(0.0, 1.0 - z * z))}, n.vec()};
  return {radius * n.vec(), direction_from(c[2], c[3], t, map)};
}

Ray cylinder_ray(const ChartPoint& p, const Support& s) {
  if (p.chart == 0) {
    const double azimuth = p.c[0] / s.radius_mm + s.twist_per_mm * p.c[1];
    const Triad t = mantle_triad(azimuth);
    return {s.radius_mm * t.n + Vec3{0, 0, p.c[1]}, direction_from(p.c[2], p.c[3], t, s.map)};
  }
  const double rho = std::min(s.radius_mm, std::sqrt(std::max(0.0, 2.0 * p.c[0])));
  const double z = p.chart == 1 ? s.half_size_mm.z : -s.half_size_mm.z;
  return {{rho * std::cos(p.c[1]), rho * std::sin(p.c[1]), z},
          direction_from(p.c[2], p.c[3], plane_triad(p.chart - 1), s.map)};
}

Ray disk_ray(const ChartPoint& p, const Support& s) {
  const double r = std::sqrt(std::max(0.0, 2.0 * p.c[0]));
  const Vec3 radius{std::cos(p.c[1]), std::sin(p.c[1]), 0.0};
  return {r * radius, direction_from(p.c[2], p.c[3], disk_triad(radius, p.chart), s.map)};
}

Ray box_ray(const ChartPoint& p, const Support& s) {
  const std::size_t axis = p.chart / 2;
  const Triad t = box_triad(p.chart);
  const Vec3 face = component(s.half_size_mm, axis) * t.n;
  return {face + unit_axis((axis + 1) % 3, p.c[0]) + unit_axis((axis + 2) % 3, p.c[1]),
          direction_from(p.c[2], p.c[3], t, s.map)};
}

Ray local_ray(const ChartPoint& p, const Support& s) {
  switch (s.kind) {
    case SupportKind::plane:
      return {{p.c[0], p.c[1], 0.0}, direction_from(p.c[2], p.c[3], plane_triad(p.chart), s.map)};
    case SupportKind::sphere:
      return sphere_ray(p.c, s.radius_mm, s.map);
    case SupportKind::cylinder:
      return cylinder_ray(p, s);
    case SupportKind::box:
      return box_ray(p, s);
    case SupportKind::focal:
      return focal_ray(p.c, s.map);
    case SupportKind::axis:
      return axis_ray(p.c, s.twist_per_mm);
    case SupportKind::disk:
      return disk_ray(p, s);
  }
  return {};
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

std::string_view to_string(SupportKind kind) { return kNames[static_cast<std::size_t>(kind)]; }

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

std::optional<ChartPoint> Support::to_chart(const Ray& world) const {
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

Ray Support::from_chart(const ChartPoint& p) const { return world_from_support.ray(local_ray(p, *this)); }

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
  if (surface.kind == SurfaceKind::none) return ray;
  if (const auto t = surface.exit_distance_mm(ray)) return {ray.at(*t), ray.direction};
  const Frame& f = surface.world_from_surface;
  const Vec3& d = ray.direction.vec();
  if (surface.kind == SurfaceKind::plane) {
    const double dz = dot(d, f.ez()), z = dot(ray.origin_mm - f.origin_mm(), f.ez());
    if (std::abs(dz) > kGrazing) return {ray.at(-z / dz), ray.direction};
    return {ray.origin_mm - z * f.ez(), ray.direction};
  }
  const Vec3 o = ray.origin_mm - f.origin_mm(), nearest = o - dot(o, d) * d;
  double hits = 0.0, misses = 1.0;  // share of the offset; at 0 the line passes the centre
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (hits + misses);
    (surface.exit_distance_mm({f.origin_mm() + middle * nearest, ray.direction}) ? hits : misses) = middle;
  }
  const Ray touching{f.origin_mm() + hits * nearest, ray.direction};
  const auto t = surface.exit_distance_mm(touching);
  LUCERNA_CHECK(t.has_value(), "a line through the centre misses its {} surface", to_string(surface.kind));
  return {touching.at(*t), ray.direction};
}

}  // namespace lucerna
