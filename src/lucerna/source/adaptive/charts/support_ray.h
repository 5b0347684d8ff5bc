// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "lucerna/source/adaptive/charts/support.h"
#include "lucerna/source/emitters/warp.h"

namespace lucerna {

// Rays from the numbers that supports write them down in, one at a time: small functions that CPU and GPU
// share. Support::from_chart and start_on are made of them.

namespace detail {

inline constexpr double kPi = std::numbers::pi;
/// Lines flatter than this to a plane, or to the axis of an axis support, have no usable coordinates there.
inline constexpr double kGrazing = 1e-6;

/// Scale of the concentric square: its area is the projected solid angle of the hemisphere, pi.
inline constexpr double kSquare = 1.7724538509055159;  // sqrt(pi)

/// A right-handed triad at a point of a surface.
struct OrthonormalBasis {
  Vec3 u, v, n;
};

LUCERNA_HD inline Direction direction_from(double a, double b, const OrthonormalBasis& t, PolarMap map) {
  double x = 0.0, y = 0.0;
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
LUCERNA_HD inline double solve_t_minus_sin(double m) {
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
LUCERNA_HD inline OrthonormalBasis plane_basis(std::uint32_t chart) {
  if (chart == 0) return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  return {{1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
}

/// On a disk azimuths of directions count from the radius, so that round sources look the same all round.
LUCERNA_HD inline OrthonormalBasis disk_basis(const Vec3& p, std::uint32_t chart) {
  const double r = std::hypot(p.x, p.y), c = r > 0.0 ? p.x / r : 1.0, s = r > 0.0 ? p.y / r : 0.0;
  if (chart == 0) return {{c, s, 0}, {-s, c, 0}, {0, 0, 1}};
  return {{c, s, 0}, {s, -c, 0}, {0, 0, -1}};
}

LUCERNA_HD inline Vec3 unit_axis(std::size_t axis, double sign) {
  return {axis == 0 ? sign : 0.0, axis == 1 ? sign : 0.0, axis == 2 ? sign : 0.0};
}

LUCERNA_HD inline double component(const Vec3& v, std::size_t axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

LUCERNA_HD inline OrthonormalBasis box_basis(std::uint32_t chart) {
  const std::size_t axis = chart / 2;
  const double sign = chart % 2 == 0 ? 1.0 : -1.0;
  return {unit_axis((axis + 1) % 3, 1.0), unit_axis((axis + 2) % 3, sign), unit_axis(axis, sign)};
}

LUCERNA_HD inline OrthonormalBasis lateral_basis(double azimuth) {
  const double c = std::cos(azimuth), s = std::sin(azimuth);
  return {{-s, c, 0}, {0, 0, 1}, {c, s, 0}};
}

LUCERNA_HD inline OrthonormalBasis sphere_basis(const Vec3& n) {
  const double across = std::hypot(n.x, n.y);
  const double c = across > 0.0 ? n.x / across : 1.0, s = across > 0.0 ? n.y / across : 0.0;
  return {{-s, c, 0}, {-n.z * c, -n.z * s, across}, n};
}

LUCERNA_HD inline Ray axis_ray(const std::array<double, 4>& c, double twist) {
  const double angle = 0.5 * solve_t_minus_sin(std::clamp(4.0 * c[2], 0.0, 2.0 * kPi));
  const double azimuth = c[3] + twist * c[0];
  const double x = std::cos(azimuth), y = std::sin(azimuth), across = std::sin(angle);
  return {{-c[1] * y, c[1] * x, c[0]}, Direction::from_unit({across * x, across * y, std::cos(angle)})};
}

LUCERNA_HD inline Ray focal_ray(const std::array<double, 4>& c, PolarMap map) {
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

LUCERNA_HD inline Ray sphere_ray(const std::array<double, 4>& c, double radius, PolarMap map) {
  const double z = std::clamp(c[0] / radius, -1.0, 1.0);
  const Direction n = warp::at_cosine(z, c[1] / (2.0 * kPi * radius));
  // At the poles the triad follows the azimuth that was stored, not the one left in n.
  const double cosine = std::cos(c[1] / radius), sine = std::sin(c[1] / radius);
  const OrthonormalBasis t{
      {-sine, cosine, 0}, {-z * cosine, -z * sine, std::sqrt(std::max(0.0, 1.0 - z * z))}, n.vec()};
  return {radius * n.vec(), direction_from(c[2], c[3], t, map)};
}

LUCERNA_HD inline Ray cylinder_ray(const ChartPoint& p, const Support& s) {
  if (p.chart == 0) {
    const double azimuth = p.c[0] / s.radius_mm + s.twist_per_mm * p.c[1];
    const OrthonormalBasis t = lateral_basis(azimuth);
    return {s.radius_mm * t.n + Vec3{0, 0, p.c[1]}, direction_from(p.c[2], p.c[3], t, s.map)};
  }
  const double rho = std::min(s.radius_mm, std::sqrt(std::max(0.0, 2.0 * p.c[0])));
  const double z = p.chart == 1 ? s.half_size_mm.z : -s.half_size_mm.z;
  return {{rho * std::cos(p.c[1]), rho * std::sin(p.c[1]), z},
          direction_from(p.c[2], p.c[3], plane_basis(p.chart - 1), s.map)};
}

LUCERNA_HD inline Ray disk_ray(const ChartPoint& p, const Support& s) {
  const double r = std::sqrt(std::max(0.0, 2.0 * p.c[0]));
  const Vec3 radius{std::cos(p.c[1]), std::sin(p.c[1]), 0.0};
  return {r * radius, direction_from(p.c[2], p.c[3], disk_basis(radius, p.chart), s.map)};
}

LUCERNA_HD inline Ray box_ray(const ChartPoint& p, const Support& s) {
  const std::size_t axis = p.chart / 2;
  const OrthonormalBasis t = box_basis(p.chart);
  const Vec3 face = component(s.half_size_mm, axis) * t.n;
  return {face + unit_axis((axis + 1) % 3, p.c[0]) + unit_axis((axis + 2) % 3, p.c[1]),
          direction_from(p.c[2], p.c[3], t, s.map)};
}

LUCERNA_HD inline Ray local_ray(const ChartPoint& p, const Support& s) {
  switch (s.kind) {
    case SupportKind::plane:
      return {{p.c[0], p.c[1], 0.0}, direction_from(p.c[2], p.c[3], plane_basis(p.chart), s.map)};
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

}  // namespace detail

/// Support::from_chart.
LUCERNA_HD inline Ray ray_from_chart(const Support& support, const ChartPoint& p) {
  const Ray ray = support.world_from_support.ray(detail::local_ray(p, support));
  return support.dome.exists() ? support.dome.outside(ray) : ray;
}

/// start_on; nothing where even a line through the surface's centre misses it, which none does.
LUCERNA_HD inline std::optional<Ray> placed_on(const BoundingSurface& surface, const Ray& ray) {
  if (surface.kind == SurfaceKind::none) return ray;
  const Frame& f = surface.world_from_surface;
  const Vec3& d = ray.direction.vec();
  const double dz = dot(d, f.ez());
  // Along a plane the way to it has no length that numbers can hold: such a ray is dropped onto it.
  const bool along_plane = surface.kind == SurfaceKind::plane && std::abs(dz) <= detail::kGrazing;
  const double z = dot(ray.origin_mm - f.origin_mm(), f.ez());
  if (along_plane) return Ray{ray.origin_mm - z * f.ez(), ray.direction};
  if (const auto t = surface.exit_distance_mm(ray)) return Ray{ray.at(*t), ray.direction};
  if (surface.kind == SurfaceKind::plane) return Ray{ray.at(-z / dz), ray.direction};
  const Vec3 o = ray.origin_mm - f.origin_mm(), nearest = o - dot(o, d) * d;
  double hits = 0.0, misses = 1.0;  // share of the offset; at 0 the line passes the centre
  for (int i = 0; i < 40; ++i) {
    const double middle = 0.5 * (hits + misses);
    (surface.exit_distance_mm({f.origin_mm() + middle * nearest, ray.direction}) ? hits : misses) = middle;
  }
  const Ray touching{f.origin_mm() + hits * nearest, ray.direction};
  const auto t = surface.exit_distance_mm(touching);
  if (!t) return std::nullopt;
  return Ray{touching.at(*t), ray.direction};
}

}  // namespace lucerna
