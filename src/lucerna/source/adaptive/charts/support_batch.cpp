// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/support_batch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/source/adaptive/charts/batch_math.h"

namespace lucerna {

namespace {

using batch::clamped;
using batch::cosine_of;
using batch::sin_cos;
using batch::SinCos;
using batch::sine_of;
using Columns = std::array<BatchColumn, 4>;

/// Projected direction across a normal, and along it.
struct Local {
  double x, y, z;
};

struct PolarDirection {
  LUCERNA_ALWAYS_INLINE Local operator()(double a, double b) const {
    const double r2 = clamped(2.0 * a, 0.0, 1.0), r = std::sqrt(r2);
    const SinCos t = sin_cos(b);
    return {r * t.cosine, r * t.sine, std::sqrt(1.0 - r2)};
  }
};

struct ConcentricDirection {
  LUCERNA_ALWAYS_INLINE Local operator()(double a, double b) const {
    constexpr double kScale = 2.0 / 1.7724538509055160273;  // 2 / sqrt(pi)
    const double u = clamped(kScale * a - 1.0, -1.0, 1.0), v = clamped(kScale * b - 1.0, -1.0, 1.0);
    // Choices as products with 0 and 1, which are exact: compilers make branches of anything else.
    const double steep = std::abs(v) > std::abs(u) ? 1.0 : 0.0, flat = 1.0 - steep;
    const double r = steep * v + flat * u, other = steep * u + flat * v;
    const double angle = 0.25 * std::numbers::pi * (other / (r + (r == 0.0 ? 1.0 : 0.0)));
    const double s = r * sine_of(angle), c = r * cosine_of(angle);
    return {steep * s + flat * c, steep * c + flat * s, std::sqrt(std::max(0.0, 1.0 - r * r))};
  }
};

/// A point of a support with the triad that directions are counted in: u, v across the normal w.
struct Place {
  Vec3 p, u, v, w;
};

struct OnPlane {
  double sign;
  LUCERNA_ALWAYS_INLINE Place operator()(double a, double b) const {
    return {{a, b, 0.0}, {1, 0, 0}, {0, sign, 0}, {0, 0, sign}};
  }
};

struct OnDisk {
  double sign;
  LUCERNA_ALWAYS_INLINE Place operator()(double a, double b) const {
    const double r = std::sqrt(std::max(0.0, 2.0 * a));
    const SinCos t = sin_cos(b);
    return {{r * t.cosine, r * t.sine, 0.0},
            {t.cosine, t.sine, 0},
            {-sign * t.sine, sign * t.cosine, 0},
            {0, 0, sign}};
  }
};

/// The ends of a cylinder, where triads do not turn with the radius.
struct OnEnd {
  double sign, z, radius;
  LUCERNA_ALWAYS_INLINE Place operator()(double a, double b) const {
    const double r = std::min(radius, std::sqrt(std::max(0.0, 2.0 * a)));
    const SinCos t = sin_cos(b);
    return {{r * t.cosine, r * t.sine, z}, {1, 0, 0}, {0, sign, 0}, {0, 0, sign}};
  }
};

struct OnSphere {
  double radius;
  LUCERNA_ALWAYS_INLINE Place operator()(double a, double b) const {
    const double z = clamped(a / radius, -1.0, 1.0), across = std::sqrt(1.0 - z * z);
    const SinCos t = sin_cos(b / radius);
    const Vec3 w{across * t.cosine, across * t.sine, z};
    return {radius * w, {-t.sine, t.cosine, 0}, {-z * t.cosine, -z * t.sine, across}, w};
  }
};

struct OnLateral {
  double radius, twist;
  LUCERNA_ALWAYS_INLINE Place operator()(double a, double b) const {
    const SinCos t = sin_cos(a / radius + twist * b);
    return {
        {radius * t.cosine, radius * t.sine, b}, {-t.sine, t.cosine, 0}, {0, 0, 1}, {t.cosine, t.sine, 0}};
  }
};

/// The face of a box `half` along `Axis`, on its side `sign`.
template <int Axis>
struct OnFace {
  double half, sign;
  /// The vector of these components along Axis and the two axes after it, in cyclic order.
  LUCERNA_ALWAYS_INLINE static Vec3 cyclic(double x, double y, double z) {
    if constexpr (Axis == 0) return {x, y, z};
    if constexpr (Axis == 1) return {z, x, y};
    return {y, z, x};
  }
  LUCERNA_ALWAYS_INLINE Place operator()(double a, double b) const {
    return {cyclic(sign * half, a, b), cyclic(0, 1, 0), cyclic(0, 0, sign), cyclic(sign, 0, 0)};
  }
};

/// Position `p` and direction `d` of ray `i` of a support's own frame, put in the world.
LUCERNA_ALWAYS_INLINE inline void put(const Frame& f, const Vec3& p, const Vec3& d, std::size_t i,
                                      RayBatch& rays) {
  const Vec3 &ex = f.ex(), &ey = f.ey(), &ez = f.ez(), &o = f.origin_mm();
  rays.x[i] = p.x * ex.x + p.y * ey.x + p.z * ez.x + o.x;
  rays.y[i] = p.x * ex.y + p.y * ey.y + p.z * ez.y + o.y;
  rays.z[i] = p.x * ex.z + p.y * ey.z + p.z * ez.z + o.z;
  rays.kx[i] = d.x * ex.x + d.y * ey.x + d.z * ez.x;
  rays.ky[i] = d.x * ex.y + d.y * ey.y + d.z * ez.y;
  rays.kz[i] = d.x * ex.z + d.y * ey.z + d.z * ez.z;
}

/// All of a batch; what lies behind its end is made and not used. Rays are made in an array of the function's
/// own: only then compilers know that nothing else is written.
template <class Map, class On>
LUCERNA_ALWAYS_INLINE inline void fill(const Support& s, const Columns& c, const Map map, const On on,
                                       RayBatch& out) {
  const Frame f = s.world_from_support;
  RayBatch rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const Place at = on(c[0][i], c[1][i]);
    const Local d = map(c[2][i], c[3][i]);
    put(f, at.p, d.x * at.u + d.y * at.v + d.z * at.w, i, rays);
  }
  out = rays;
}

LUCERNA_VECTOR_CLONES void fill_plane(const Support& s, double sign, const Columns& c, RayBatch& out) {
  if (s.map == PolarMap::polar) return fill(s, c, PolarDirection(), OnPlane{sign}, out);
  fill(s, c, ConcentricDirection(), OnPlane{sign}, out);
}

LUCERNA_VECTOR_CLONES void fill_disk(const Support& s, double sign, const Columns& c, RayBatch& out) {
  if (s.map == PolarMap::polar) return fill(s, c, PolarDirection(), OnDisk{sign}, out);
  fill(s, c, ConcentricDirection(), OnDisk{sign}, out);
}

LUCERNA_VECTOR_CLONES void fill_end(const Support& s, double sign, const Columns& c, RayBatch& out) {
  const OnEnd on{sign, sign * s.half_size_mm.z, s.radius_mm};
  if (s.map == PolarMap::polar) return fill(s, c, PolarDirection(), on, out);
  fill(s, c, ConcentricDirection(), on, out);
}

LUCERNA_VECTOR_CLONES void fill_sphere(const Support& s, const Columns& c, RayBatch& out) {
  if (s.map == PolarMap::polar) return fill(s, c, PolarDirection(), OnSphere{s.radius_mm}, out);
  fill(s, c, ConcentricDirection(), OnSphere{s.radius_mm}, out);
}

LUCERNA_VECTOR_CLONES void fill_lateral(const Support& s, const Columns& c, RayBatch& out) {
  const OnLateral on{s.radius_mm, s.twist_per_mm};
  if (s.map == PolarMap::polar) return fill(s, c, PolarDirection(), on, out);
  fill(s, c, ConcentricDirection(), on, out);
}

template <int Axis>
LUCERNA_ALWAYS_INLINE inline void fill_face(const Support& s, double half, double sign, const Columns& c,
                                            RayBatch& out) {
  if (s.map == PolarMap::polar) return fill(s, c, PolarDirection(), OnFace<Axis>{half, sign}, out);
  fill(s, c, ConcentricDirection(), OnFace<Axis>{half, sign}, out);
}

LUCERNA_VECTOR_CLONES void fill_box(const Support& s, std::uint32_t chart, const Columns& c, RayBatch& out) {
  const double sign = chart % 2 == 0 ? 1.0 : -1.0;
  if (chart / 2 == 0) return fill_face<0>(s, s.half_size_mm.x, sign, c, out);
  if (chart / 2 == 1) return fill_face<1>(s, s.half_size_mm.y, sign, c, out);
  fill_face<2>(s, s.half_size_mm.z, sign, c, out);
}

/// Offsets x, y across a direction of cosine `z` and azimuth `t` to the axis.
LUCERNA_ALWAYS_INLINE inline void put_focal(const Frame& f, double x, double y, double cosine, const SinCos t,
                                            std::size_t i, RayBatch& rays) {
  const double z = clamped(cosine, -1.0, 1.0), across = std::sqrt(1.0 - z * z);
  const Vec3 p{-x * z * t.cosine - y * t.sine, -x * z * t.sine + y * t.cosine, x * across};
  put(f, p, {across * t.cosine, across * t.sine, z}, i, rays);
}

LUCERNA_VECTOR_CLONES void fill_focal(const Support& s, const Columns& c, RayBatch& out) {
  const Frame f = s.world_from_support;
  RayBatch rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    put_focal(f, c[0][i], c[1][i], c[2][i], sin_cos(c[3][i]), i, rays);
  }
  out = rays;
}

LUCERNA_VECTOR_CLONES void fill_focal_polar(const Support& s, const Columns& c, RayBatch& out) {
  const Frame f = s.world_from_support;
  RayBatch rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double r = std::sqrt(std::max(0.0, 2.0 * c[0][i]));
    const SinCos t = sin_cos(c[1][i]);
    put_focal(f, r * t.cosine, r * t.sine, c[2][i], sin_cos(c[3][i]), i, rays);
  }
  out = rays;
}

LUCERNA_VECTOR_CLONES void fill_axis(const Support& s, const Columns& c, RayBatch& out) {
  const Frame f = s.world_from_support;
  const double twist = s.twist_per_mm;
  RayBatch rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double z = c[0][i], b = c[1][i];
    const SinCos angle =
        sin_cos(batch::half_kepler_angle(clamped(4.0 * c[2][i], 0.0, 2.0 * std::numbers::pi)));
    const SinCos t = sin_cos(c[3][i] + twist * z);
    put(f, {-b * t.sine, b * t.cosine, z}, {angle.sine * t.cosine, angle.sine * t.sine, angle.cosine}, i,
        rays);
  }
  out = rays;
}

/// RefractingSphere::outside for all rays.
LUCERNA_VECTOR_CLONES void leave_dome(const RefractingSphere dome, const RayBatch& r, RayBatch& to) {
  const Vec3 o = dome.centre_mm;
  const double index = dome.index, radius = dome.radius_mm, inverse = 1.0 / radius;
  const double max = (1.0 - 1e-9) / index;
  RayBatch rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double kx = r.kx[i], ky = r.ky[i], kz = r.kz[i];
    const double x = (r.x[i] - o.x) * inverse, y = (r.y[i] - o.y) * inverse, z = (r.z[i] - o.z) * inverse;
    const double along = x * kx + y * ky + z * kz;
    double qx = x - along * kx, qy = y - along * ky, qz = z - along * kz;
    const double q = std::sqrt(qx * qx + qy * qy + qz * qz);
    const double scale = std::min(1.0, max / std::max(q, 1e-300));
    qx *= scale, qy *= scale, qz *= scale;
    const double sine = q * scale, in = std::sqrt(1.0 - sine * sine);
    const double out = std::sqrt(std::max(0.0, 1.0 - index * index * sine * sine)), turn = out - index * in;
    const double nx = qx + in * kx, ny = qy + in * ky, nz = qz + in * kz;
    rays.x[i] = o.x + radius * nx, rays.y[i] = o.y + radius * ny, rays.z[i] = o.z + radius * nz;
    rays.kx[i] = index * kx + turn * nx;
    rays.ky[i] = index * ky + turn * ny;
    rays.kz[i] = index * kz + turn * nz;
  }
  to = rays;
}

void rays_inside(const Support& s, std::uint32_t chart, const Columns& c, RayBatch& out) {
  const double sign = chart == 0 ? 1.0 : -1.0;
  switch (s.kind) {
    case SupportKind::plane:
      return fill_plane(s, sign, c, out);
    case SupportKind::disk:
      return fill_disk(s, sign, c, out);
    case SupportKind::sphere:
      return fill_sphere(s, c, out);
    case SupportKind::cylinder:
      return chart == 0 ? fill_lateral(s, c, out) : fill_end(s, chart == 1 ? 1.0 : -1.0, c, out);
    case SupportKind::box:
      return fill_box(s, chart, c, out);
    case SupportKind::focal:
      return s.map == PolarMap::polar ? fill_focal_polar(s, c, out) : fill_focal(s, c, out);
    case SupportKind::axis:
      return fill_axis(s, c, out);
  }
}

}  // namespace

void rays_from_chart(const Support& support, std::uint32_t chart, const std::array<BatchColumn, 4>& c,
                     RayBatch& out) {
  rays_inside(support, chart, c, out);
  if (support.dome.exists()) leave_dome(support.dome, out, out);
}

}  // namespace lucerna
