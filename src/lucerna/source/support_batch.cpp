// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/support_batch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr double kPi = std::numbers::pi;

struct SinCos {
  double sine, cosine;
};

/// Taylor polynomials, exact to 2e-14 for |t| <= pi / 2.
inline double sine_of(double t) {
  const double t2 = t * t;
  double s = 1.0 / 355687428096000.0;
  s = s * t2 - 1.0 / 1307674368000.0;
  s = s * t2 + 1.0 / 6227020800.0;
  s = s * t2 - 1.0 / 39916800.0;
  s = s * t2 + 1.0 / 362880.0;
  s = s * t2 - 1.0 / 5040.0;
  s = s * t2 + 1.0 / 120.0;
  s = s * t2 - 1.0 / 6.0;
  return t + t * t2 * s;
}
inline double cosine_of(double t) {
  const double t2 = t * t;
  double c = -1.0 / 6402373705728000.0;
  c = c * t2 + 1.0 / 20922789888000.0;
  c = c * t2 - 1.0 / 87178291200.0;
  c = c * t2 + 1.0 / 479001600.0;
  c = c * t2 - 1.0 / 3628800.0;
  c = c * t2 + 1.0 / 40320.0;
  c = c * t2 - 1.0 / 720.0;
  c = c * t2 + 1.0 / 24.0;
  c = c * t2 - 0.5;
  return 1.0 + t2 * c;
}

/// The nearest integer for |x| < 2^51, by the rounding of additions.
inline double nearest_integer(double x) {
  constexpr double kMagic = 6755399441055744.0;  // 1.5 * 2^52
  return (x + kMagic) - kMagic;
}

/// Any angle: brought to one turn, halved, doubled.
inline SinCos sin_cos(double angle) {
  const double turns = nearest_integer(angle * (0.5 / kPi));
  const double half = 0.5 * (angle - turns * (2.0 * kPi));
  const double s = sine_of(half), c = cosine_of(half);
  return {2.0 * s * c, 1.0 - 2.0 * s * s};
}

/// Projected direction across a normal, and along it.
struct Local {
  double x, y, z;
};

inline Local polar_direction(double a, double b) {
  const double r2 = std::clamp(2.0 * a, 0.0, 1.0), r = std::sqrt(r2);
  const SinCos t = sin_cos(b);
  return {r * t.cosine, r * t.sine, std::sqrt(1.0 - r2)};
}

inline Local concentric_direction(double a, double b) {
  constexpr double kScale = 2.0 / 1.7724538509055160273;  // 2 / sqrt(pi)
  const double u = std::clamp(kScale * a - 1.0, -1.0, 1.0), v = std::clamp(kScale * b - 1.0, -1.0, 1.0);
  const bool steep = std::abs(v) > std::abs(u);
  const double r = steep ? v : u, other = steep ? u : v;
  const double angle = 0.25 * kPi * (other / (r == 0.0 ? 1.0 : r));
  const double s = r * sine_of(angle), c = r * cosine_of(angle);
  return {steep ? s : c, steep ? c : s, std::sqrt(std::max(0.0, 1.0 - r * r))};
}

/// Every form is `place(c, i) -> position, triad` and a map of directions; the loop is the same.
template <class Map, class Place>
void fill(const Frame& f, const std::array<BatchColumn, 4>& c, std::size_t n, RayBatch& out, const Map& map,
          const Place& place) {
  const Vec3 ex = f.ex(), ey = f.ey(), ez = f.ez(), o = f.origin_mm();
  for (std::size_t i = 0; i < n; ++i) {
    Vec3 p, u, v, w;
    place(c[0][i], c[1][i], p, u, v, w);
    const Local d = map(c[2][i], c[3][i]);
    const double dx = d.x * u.x + d.y * v.x + d.z * w.x, dy = d.x * u.y + d.y * v.y + d.z * w.y;
    const double dz = d.x * u.z + d.y * v.z + d.z * w.z;
    out.x[i] = p.x * ex.x + p.y * ey.x + p.z * ez.x + o.x;
    out.y[i] = p.x * ex.y + p.y * ey.y + p.z * ez.y + o.y;
    out.z[i] = p.x * ex.z + p.y * ey.z + p.z * ez.z + o.z;
    out.kx[i] = dx * ex.x + dy * ey.x + dz * ez.x;
    out.ky[i] = dx * ex.y + dy * ey.y + dz * ez.y;
    out.kz[i] = dx * ex.z + dy * ey.z + dz * ez.z;
  }
}

template <class Map>
bool fill_surface(const Support& s, std::uint32_t chart, const std::array<BatchColumn, 4>& c, std::size_t n,
                  RayBatch& out, const Map& map) {
  const Frame& f = s.world_from_support;
  const double sign = chart == 0 ? 1.0 : -1.0;
  if (s.kind == SupportKind::plane) {
    fill(f, c, n, out, map, [sign](double a, double b, Vec3& p, Vec3& u, Vec3& v, Vec3& w) {
      p = {a, b, 0.0}, u = {1, 0, 0}, v = {0, sign, 0}, w = {0, 0, sign};
    });
    return true;
  }
  if (s.kind == SupportKind::disk) {
    fill(f, c, n, out, map, [sign](double a, double b, Vec3& p, Vec3& u, Vec3& v, Vec3& w) {
      const double r = std::sqrt(std::max(0.0, 2.0 * a));
      const SinCos t = sin_cos(b);
      p = {r * t.cosine, r * t.sine, 0.0}, u = {t.cosine, t.sine, 0};
      v = {-sign * t.sine, sign * t.cosine, 0}, w = {0, 0, sign};
    });
    return true;
  }
  if (s.kind == SupportKind::sphere) {
    const double radius = s.radius_mm, inverse = 1.0 / s.radius_mm;
    fill(f, c, n, out, map, [=](double a, double b, Vec3& p, Vec3& u, Vec3& v, Vec3& w) {
      const double z = std::clamp(a * inverse, -1.0, 1.0), across = std::sqrt(1.0 - z * z);
      const SinCos t = sin_cos(b * inverse);
      w = {across * t.cosine, across * t.sine, z}, p = radius * w;
      u = {-t.sine, t.cosine, 0}, v = {-z * t.cosine, -z * t.sine, across};
    });
    return true;
  }
  if (s.kind == SupportKind::cylinder && chart == 0) {
    const double radius = s.radius_mm, inverse = 1.0 / s.radius_mm, twist = s.twist_per_mm;
    fill(f, c, n, out, map, [=](double a, double b, Vec3& p, Vec3& u, Vec3& v, Vec3& w) {
      const SinCos t = sin_cos(a * inverse + twist * b);
      p = {radius * t.cosine, radius * t.sine, b}, u = {-t.sine, t.cosine, 0};
      v = {0, 0, 1}, w = {t.cosine, t.sine, 0};
    });
    return true;
  }
  return false;
}

void fill_focal(const Support& s, const std::array<BatchColumn, 4>& c, std::size_t n, RayBatch& out) {
  const Vec3 ex = s.world_from_support.ex(), ey = s.world_from_support.ey(), ez = s.world_from_support.ez();
  const Vec3 o = s.world_from_support.origin_mm();
  const bool polar = s.map == PolarMap::polar;
  for (std::size_t i = 0; i < n; ++i) {
    double x = c[0][i], y = c[1][i];
    if (polar) {
      const double r = std::sqrt(std::max(0.0, 2.0 * c[0][i]));
      const SinCos t = sin_cos(c[1][i]);
      x = r * t.cosine, y = r * t.sine;
    }
    const double z = std::clamp(c[2][i], -1.0, 1.0), across = std::sqrt(1.0 - z * z);
    const SinCos t = sin_cos(c[3][i]);
    const Vec3 d{across * t.cosine, across * t.sine, z};
    const Vec3 p{-x * z * t.cosine - y * t.sine, -x * z * t.sine + y * t.cosine, x * across};
    out.x[i] = p.x * ex.x + p.y * ey.x + p.z * ez.x + o.x;
    out.y[i] = p.x * ex.y + p.y * ey.y + p.z * ez.y + o.y;
    out.z[i] = p.x * ex.z + p.y * ey.z + p.z * ez.z + o.z;
    out.kx[i] = d.x * ex.x + d.y * ey.x + d.z * ez.x;
    out.ky[i] = d.x * ex.y + d.y * ey.y + d.z * ez.y;
    out.kz[i] = d.x * ex.z + d.y * ey.z + d.z * ez.z;
  }
}

void on_sphere(const BoundingSurface& s, std::size_t n, RayBatch& r) {
  const Vec3 o = s.world_from_surface.origin_mm();
  const double radius2 = s.radius_mm * s.radius_mm;
  double least = 1.0;
  BatchColumn rest;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = r.x[i] - o.x, y = r.y[i] - o.y, z = r.z[i] - o.z;
    const double along = x * r.kx[i] + y * r.ky[i] + z * r.kz[i];
    const double qx = x - along * r.kx[i], qy = y - along * r.ky[i], qz = z - along * r.kz[i];
    rest[i] = radius2 - (qx * qx + qy * qy + qz * qz);
    least = std::min(least, rest[i]);
    const double t = std::sqrt(std::max(0.0, rest[i])) - along;
    if (rest[i] < 0.0) continue;
    r.x[i] += t * r.kx[i], r.y[i] += t * r.ky[i], r.z[i] += t * r.kz[i];
  }
  if (least >= 0.0) return;
  for (std::size_t i = 0; i < n; ++i) {
    if (rest[i] < 0.0) r.set(i, start_on(s, r.ray(i)));
  }
}

void on_plane(const BoundingSurface& s, std::size_t n, RayBatch& r) {
  const Vec3 o = s.world_from_surface.origin_mm(), w = s.world_from_surface.ez();
  for (std::size_t i = 0; i < n; ++i) {
    const double dz = r.kx[i] * w.x + r.ky[i] * w.y + r.kz[i] * w.z;
    const double z = (r.x[i] - o.x) * w.x + (r.y[i] - o.y) * w.y + (r.z[i] - o.z) * w.z;
    if (std::abs(dz) < 1e-3) {
      r.set(i, start_on(s, r.ray(i)));
      continue;
    }
    const double t = -z / dz;
    r.x[i] += t * r.kx[i], r.y[i] += t * r.ky[i], r.z[i] += t * r.kz[i];
  }
}

/// RefractingSphere::outside for all rays.
void leave_dome(const RefractingSphere& dome, std::size_t n, RayBatch& r) {
  const Vec3 o = dome.centre_mm;
  const double index = dome.index, radius = dome.radius_mm, inverse = 1.0 / radius;
  const double most = (1.0 - 1e-9) / index;
  for (std::size_t i = 0; i < n; ++i) {
    const double x = (r.x[i] - o.x) * inverse, y = (r.y[i] - o.y) * inverse, z = (r.z[i] - o.z) * inverse;
    const double along = x * r.kx[i] + y * r.ky[i] + z * r.kz[i];
    double qx = x - along * r.kx[i], qy = y - along * r.ky[i], qz = z - along * r.kz[i];
    const double q = std::sqrt(qx * qx + qy * qy + qz * qz);
    const double scale = std::min(1.0, most / std::max(q, 1e-300));
    qx *= scale, qy *= scale, qz *= scale;
    const double sine = q * scale, in = std::sqrt(1.0 - sine * sine);
    const double out = std::sqrt(std::max(0.0, 1.0 - index * index * sine * sine)), turn = out - index * in;
    const double nx = qx + in * r.kx[i], ny = qy + in * r.ky[i], nz = qz + in * r.kz[i];
    r.x[i] = o.x + radius * nx, r.y[i] = o.y + radius * ny, r.z[i] = o.z + radius * nz;
    r.kx[i] = index * r.kx[i] + turn * nx;
    r.ky[i] = index * r.ky[i] + turn * ny;
    r.kz[i] = index * r.kz[i] + turn * nz;
  }
}

void rays_inside(const Support& support, std::uint32_t chart, const std::array<BatchColumn, 4>& c,
                 std::size_t n, RayBatch& out) {
  if (support.kind == SupportKind::focal) return fill_focal(support, c, n, out);
  const bool done =
      support.map == PolarMap::polar
          ? fill_surface(support, chart, c, n, out, [](double a, double b) { return polar_direction(a, b); })
          : fill_surface(support, chart, c, n, out,
                         [](double a, double b) { return concentric_direction(a, b); });
  if (done) return;
  Support bare = support;
  bare.dome = {};
  for (std::size_t i = 0; i < n; ++i) {
    out.set(i, bare.from_chart({chart, {c[0][i], c[1][i], c[2][i], c[3][i]}}));
  }
}

}  // namespace

void rays_from_chart(const Support& support, std::uint32_t chart, const std::array<BatchColumn, 4>& c,
                     std::size_t n, RayBatch& out) {
  rays_inside(support, chart, c, n, out);
  if (support.dome.exists()) leave_dome(support.dome, n, out);
}

void start_batch_on(const BoundingSurface& surface, std::size_t n, RayBatch& rays) {
  if (surface.kind == SurfaceKind::none) return;
  if (surface.kind == SurfaceKind::sphere) return on_sphere(surface, n, rays);
  if (surface.kind == SurfaceKind::plane) return on_plane(surface, n, rays);
  for (std::size_t i = 0; i < n; ++i) rays.set(i, start_on(surface, rays.ray(i)));
}

}  // namespace lucerna
