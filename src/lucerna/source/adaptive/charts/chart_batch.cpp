// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/charts/chart_batch.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "lucerna/core/io/error.h"
#include "lucerna/source/adaptive/charts/batch_math.h"
#include "lucerna/source/adaptive/charts/local_batch.h"

namespace lucerna {

namespace {

constexpr double kPi = std::numbers::pi;
/// As in Support::to_chart.
constexpr double kGrazing = 1e-6;
/// Lines nearer than this to a face's plane are taken one at a time.
constexpr double kAlong = 1e-12;
/// In place of a chart's number.
constexpr double kMissed = -1.0, kOneByOne = -2.0;

/// The four numbers of every line, and its chart.
struct Columns {
  std::array<BatchColumn, 4> c;
  BatchColumn chart;
};

/// Two numbers of a position or a direction.
struct Pair {
  double a, b;
};

struct PolarNumbers {
  LUCERNA_ALWAYS_INLINE Pair operator()(double x, double y) const {
    return {std::min(0.5, 0.5 * (x * x + y * y)), batch::azimuth(y, x)};
  }
};

/// The inverse of warp::disk, scaled to an area of pi.
struct ConcentricNumbers {
  LUCERNA_ALWAYS_INLINE Pair operator()(double x, double y) const {
    constexpr double kHalf = 0.5 * 1.7724538509055160273, kSlope = 4.0 / kPi;
    const double across = std::abs(x), up = std::abs(y);
    const bool steep = up > across;
    const double r = std::sqrt(x * x + y * y);
    const double less = r * kSlope * batch::arc_tangent(steep ? across : up, steep ? up : across);
    const double u = steep ? less : r, v = steep ? r : less;
    return {kHalf * (1.0 + (x < 0.0 ? -u : u)), kHalf * (1.0 + (y < 0.0 ? -v : v))};
  }
};

/// Where a line hits a support: two numbers, its direction's parts across the normal, and the chart.
struct Hit {
  double c0, c1, x, y, chart;
};

/// Cosine and sine of a point's azimuth; 1 and 0 on the axis.
LUCERNA_ALWAYS_INLINE inline Pair radius_direction(double x, double y, double rho) {
  const bool off = rho > 0.0;
  const double inverse = 1.0 / (off ? rho : 1.0);
  return {off ? x * inverse : 1.0, y * inverse};
}

struct OntoPlane {
  LUCERNA_ALWAYS_INLINE Hit operator()(const LocalRay& l) const {
    const double t = -l.oz / l.dz;
    const bool up = l.dz > 0.0;
    const double chart = std::abs(l.dz) < kGrazing ? kMissed : up ? 0.0 : 1.0;
    return {l.ox + t * l.dx, l.oy + t * l.dy, l.dx, up ? l.dy : -l.dy, chart};
  }
};

struct OntoDisk {
  LUCERNA_ALWAYS_INLINE Hit operator()(const LocalRay& l) const {
    const double t = -l.oz / l.dz, x = l.ox + t * l.dx, y = l.oy + t * l.dy;
    const bool up = l.dz > 0.0;
    const double chart = std::abs(l.dz) < kGrazing ? kMissed : up ? 0.0 : 1.0;
    const double rho2 = x * x + y * y;
    const Pair r = radius_direction(x, y, std::sqrt(rho2));
    const double turned = r.a * l.dy - r.b * l.dx;
    return {0.5 * rho2, batch::azimuth(y, x), r.a * l.dx + r.b * l.dy, up ? turned : -turned, chart};
  }
};

struct OntoSphere {
  double radius;
  LUCERNA_ALWAYS_INLINE Hit operator()(const LocalRay& l) const {
    const double along = l.ox * l.dx + l.oy * l.dy + l.oz * l.dz;
    const double qx = l.ox - along * l.dx, qy = l.oy - along * l.dy, qz = l.oz - along * l.dz;
    const double rest = radius * radius - (qx * qx + qy * qy + qz * qz),
                 reach = std::sqrt(std::max(0.0, rest));
    const double x = qx + reach * l.dx, y = qy + reach * l.dy, z = qz + reach * l.dz;
    const double inverse = 1.0 / std::sqrt(x * x + y * y + z * z);
    const double nx = x * inverse, ny = y * inverse, nz = z * inverse, across = std::sqrt(nx * nx + ny * ny);
    const Pair r = radius_direction(nx, ny, across);
    return {radius * nz, radius * batch::azimuth(ny, nx), r.a * l.dy - r.b * l.dx,
            across * l.dz - nz * (r.a * l.dx + r.b * l.dy), rest < 0.0 ? kMissed : 0.0};
  }
};

struct OntoCylinder {
  double radius, half, twist;
  LUCERNA_ALWAYS_INLINE Hit operator()(const LocalRay& l) const {
    const double a = l.dx * l.dx + l.dy * l.dy, inverse = 1.0 / a,
                 along = (l.ox * l.dx + l.oy * l.dy) * inverse;
    const double qx = l.ox - along * l.dx, qy = l.oy - along * l.dy,
                 rest = radius * radius - (qx * qx + qy * qy);
    const double w = std::sqrt(std::max(0.0, rest) * inverse), iz = 1.0 / l.dz;
    const double mz = -l.oz * iz, wz = std::abs(half * iz);
    const double far = std::min(w - along, mz + wz), near = std::max(-along - w, mz - wz);
    const double x = l.ox + far * l.dx, y = l.oy + far * l.dy, z = l.oz + far * l.dz;
    const double rho = std::sqrt(x * x + y * y), azimuth = batch::azimuth(y, x);
    // Beside the rim both faces are near: as Support::to_chart has it.
    const bool end = half - std::abs(z)<radius - rho, top = z> 0.0;
    const double angle = azimuth - twist * z;
    const double turned = angle - 2.0 * kPi * batch::nearest_integer(angle * (0.5 / kPi));
    const Pair r = radius_direction(x, y, rho);
    const double min = std::min(a, std::abs(l.dz));
    const double chart = end ? (top ? 1.0 : 2.0) : 0.0;
    const double found = rest >= 0.0 && near <= far ? chart : kMissed;
    return {end ? 0.5 * rho * rho : radius * batch::clamped(turned, -kPi, kPi), end ? azimuth : z,
            end ? l.dx : r.a * l.dy - r.b * l.dx, end ? (top ? l.dy : -l.dy) : l.dz,
            min > kAlong ? found : kOneByOne};
  }
};

struct OntoBox {
  double hx, hy, hz;
  LUCERNA_ALWAYS_INLINE Hit operator()(const LocalRay& l) const {
    const double ix = 1.0 / l.dx, iy = 1.0 / l.dy, iz = 1.0 / l.dz;
    const double mx = -l.ox * ix, my = -l.oy * iy, mz = -l.oz * iz;
    const double wx = std::abs(hx * ix), wy = std::abs(hy * iy), wz = std::abs(hz * iz);
    const double fx = mx + wx, fy = my + wy, fz = mz + wz, far = std::min(fx, std::min(fy, fz));
    const double near = std::max(mx - wx, std::max(my - wy, mz - wz));
    const double x = l.ox + far * l.dx, y = l.oy + far * l.dy, z = l.oz + far * l.dz;
    const bool on_x = fx <= far, on_y = !on_x && fy <= far;
    const double outward = on_x ? l.dx : on_y ? l.dy : l.dz, third = on_x ? l.dz : on_y ? l.dx : l.dy;
    const double chart = (on_x ? 0.0 : on_y ? 2.0 : 4.0) + (outward > 0.0 ? 0.0 : 1.0);
    const double min = std::min(std::abs(l.dx), std::min(std::abs(l.dy), std::abs(l.dz)));
    return {on_x   ? y
            : on_y ? z
                   : x,
            on_x   ? z
            : on_y ? x
                   : y,
            on_x   ? l.dy
            : on_y ? l.dz
                   : l.dx,
            outward > 0.0 ? third : -third, min > kAlong ? (near <= far ? chart : kMissed) : kOneByOne};
  }
};

/// All lines of a batch; in an array of the function's own, so that compilers know that nothing else is
/// written.
template <class Map, class Onto>
LUCERNA_ALWAYS_INLINE inline void fill(const Frame& frame, const RayBatch& r, const Map map, const Onto onto,
                                       Columns& out) {
  const Frame f = frame;
  Columns to;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const Hit h = onto(local_ray(f, r, i));
    const Pair p = map(h.x, h.y);
    to.c[0][i] = h.c0, to.c[1][i] = h.c1, to.c[2][i] = p.a, to.c[3][i] = p.b;
    to.chart[i] = h.chart;
  }
  out = to;
}

LUCERNA_VECTOR_CLONES void plane_polar(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, PolarNumbers{}, OntoPlane{}, out);
}
LUCERNA_VECTOR_CLONES void plane_concentric(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, ConcentricNumbers{}, OntoPlane{}, out);
}
LUCERNA_VECTOR_CLONES void disk_polar(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, PolarNumbers{}, OntoDisk{}, out);
}
LUCERNA_VECTOR_CLONES void disk_concentric(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, ConcentricNumbers{}, OntoDisk{}, out);
}
LUCERNA_VECTOR_CLONES void sphere_polar(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, PolarNumbers{}, OntoSphere{s.radius_mm}, out);
}
LUCERNA_VECTOR_CLONES void sphere_concentric(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, ConcentricNumbers{}, OntoSphere{s.radius_mm}, out);
}
LUCERNA_VECTOR_CLONES void cylinder_polar(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, PolarNumbers{}, OntoCylinder{s.radius_mm, s.half_size_mm.z, s.twist_per_mm},
       out);
}
LUCERNA_VECTOR_CLONES void cylinder_concentric(const Support& s, const RayBatch& r, Columns& out) {
  fill(s.world_from_support, r, ConcentricNumbers{},
       OntoCylinder{s.radius_mm, s.half_size_mm.z, s.twist_per_mm}, out);
}
LUCERNA_VECTOR_CLONES void box_polar(const Support& s, const RayBatch& r, Columns& out) {
  const Vec3 h = s.half_size_mm;
  fill(s.world_from_support, r, PolarNumbers{}, OntoBox{h.x, h.y, h.z}, out);
}
LUCERNA_VECTOR_CLONES void box_concentric(const Support& s, const RayBatch& r, Columns& out) {
  const Vec3 h = s.half_size_mm;
  fill(s.world_from_support, r, ConcentricNumbers{}, OntoBox{h.x, h.y, h.z}, out);
}

/// Where a line passes the origin across it, and its direction.
struct Focal {
  double x, y, cosine, azimuth;

  LUCERNA_ALWAYS_INLINE explicit Focal(const LocalRay& l) {
    const double along = l.ox * l.dx + l.oy * l.dy + l.oz * l.dz;
    const double px = l.ox - along * l.dx, py = l.oy - along * l.dy, pz = l.oz - along * l.dz;
    const double across = std::sqrt(l.dx * l.dx + l.dy * l.dy);
    const Pair r = radius_direction(l.dx, l.dy, across);
    x = across * pz - l.dz * (r.a * px + r.b * py), y = r.a * py - r.b * px;
    cosine = l.dz, azimuth = batch::azimuth(l.dy, l.dx);
  }
};

LUCERNA_VECTOR_CLONES void focal(const Support& s, const RayBatch& r, Columns& out) {
  const Frame f = s.world_from_support;
  Columns to;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const Focal n(local_ray(f, r, i));
    to.c[0][i] = n.x, to.c[1][i] = n.y, to.c[2][i] = n.cosine, to.c[3][i] = n.azimuth;
    to.chart[i] = 0.0;
  }
  out = to;
}

LUCERNA_VECTOR_CLONES void focal_polar(const Support& s, const RayBatch& r, Columns& out) {
  const Frame f = s.world_from_support;
  Columns to;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const Focal n(local_ray(f, r, i));
    to.c[0][i] = 0.5 * (n.x * n.x + n.y * n.y), to.c[1][i] = batch::azimuth(n.y, n.x);
    to.c[2][i] = n.cosine, to.c[3][i] = n.azimuth;
    to.chart[i] = 0.0;
  }
  out = to;
}

LUCERNA_VECTOR_CLONES void axis(const Support& s, const RayBatch& r, Columns& out) {
  const Frame f = s.world_from_support;
  const double twist = s.twist_per_mm;
  Columns to;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const LocalRay l = local_ray(f, r, i);
    const double across = std::sqrt(l.dx * l.dx + l.dy * l.dy), inverse = 1.0 / across;
    const double c = l.dx * inverse, sine = l.dy * inverse;
    const double z = l.oz - (l.ox * c + l.oy * sine) * inverse * l.dz;
    const double angle = batch::azimuth(across, l.dz), azimuth = batch::azimuth(l.dy, l.dx) - twist * z;
    const double turned = azimuth - 2.0 * kPi * batch::nearest_integer(azimuth * (0.5 / kPi));
    to.c[0][i] = z, to.c[1][i] = l.oy * c - l.ox * sine;
    to.c[2][i] = 0.5 * (angle - across * l.dz), to.c[3][i] = batch::clamped(turned, -kPi, kPi);
    to.chart[i] = across < kGrazing ? kMissed : 0.0;
  }
  out = to;
}

/// RefractingSphere::inside for all rays; `missed` is 1 for lines that miss the ball, else 0.
LUCERNA_VECTOR_CLONES void enter_dome(const RefractingSphere& dome, const RayBatch& r, RayBatch& to,
                                      BatchColumn& missed) {
  const Vec3 o = dome.centre_mm;
  const double radius = dome.radius_mm, inverse = 1.0 / radius, weaker = 1.0 / dome.index;
  constexpr double kMax = RefractingSphere::kLeaves * RefractingSphere::kLeaves;
  RayBatch rays;
  BatchColumn beside;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double kx = r.kx[i], ky = r.ky[i], kz = r.kz[i];
    const double x = (r.x[i] - o.x) * inverse, y = (r.y[i] - o.y) * inverse, z = (r.z[i] - o.z) * inverse;
    const double along = x * kx + y * ky + z * kz;
    const double qx = x - along * kx, qy = y - along * ky, qz = z - along * kz;
    const double sine2 = qx * qx + qy * qy + qz * qz;
    const double out = std::sqrt(std::max(0.0, 1.0 - sine2));
    const double in = std::sqrt(std::max(0.0, 1.0 - sine2 * weaker * weaker)), turn = in - out * weaker;
    const double nx = qx + out * kx, ny = qy + out * ky, nz = qz + out * kz;
    rays.x[i] = o.x + radius * nx, rays.y[i] = o.y + radius * ny, rays.z[i] = o.z + radius * nz;
    const double dx = weaker * kx + turn * nx, dy = weaker * ky + turn * ny, dz = weaker * kz + turn * nz;
    const double unit = 1.0 / std::sqrt(dx * dx + dy * dy + dz * dz);
    rays.kx[i] = dx * unit, rays.ky[i] = dy * unit, rays.kz[i] = dz * unit;
    beside[i] = sine2 > kMax ? 1.0 : 0.0;
  }
  to = rays;
  missed = beside;
}

LUCERNA_VECTOR_CLONES void make_unit(RayBatch& rays) {
  RayBatch to = rays;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    const double x = to.kx[i], y = to.ky[i], z = to.kz[i], size = std::sqrt(x * x + y * y + z * z);
    to.kx[i] = x / size, to.ky[i] = y / size, to.kz[i] = z / size;
  }
  rays.kx = to.kx, rays.ky = to.ky, rays.kz = to.kz;
}

void columns_inside(const Support& s, const RayBatch& r, Columns& out) {
  const bool polar = s.map == PolarMap::polar;
  switch (s.kind) {
    case SupportKind::plane:
      return polar ? plane_polar(s, r, out) : plane_concentric(s, r, out);
    case SupportKind::disk:
      return polar ? disk_polar(s, r, out) : disk_concentric(s, r, out);
    case SupportKind::sphere:
      return polar ? sphere_polar(s, r, out) : sphere_concentric(s, r, out);
    case SupportKind::cylinder:
      return polar ? cylinder_polar(s, r, out) : cylinder_concentric(s, r, out);
    case SupportKind::box:
      return polar ? box_polar(s, r, out) : box_concentric(s, r, out);
    case SupportKind::focal:
      return polar ? focal_polar(s, r, out) : focal(s, r, out);
    case SupportKind::axis:
      return axis(s, r, out);
  }
}

}  // namespace

void load_batch(const RayBlock& rays, std::size_t first, std::size_t stride, std::size_t n, RayBatch& to) {
  LUCERNA_CHECK(n > 0 && n <= kSupportBatch, "{} rays in a batch of {}", n, kSupportBatch);
  const std::array<const float*, 6> from{rays.x_mm.data(), rays.y_mm.data(), rays.z_mm.data(),
                                         rays.kx.data(),   rays.ky.data(),   rays.kz.data()};
  const std::array<BatchColumn*, 6> columns{&to.x, &to.y, &to.z, &to.kx, &to.ky, &to.kz};
  for (std::size_t k = 0; k < columns.size(); ++k) {
    BatchColumn& column = *columns[k];
    for (std::size_t i = 0; i < n; ++i) column[i] = static_cast<double>(from[k][first + i * stride]);
    std::fill(column.begin() + static_cast<std::ptrdiff_t>(n), column.end(), column[n - 1]);
  }
  make_unit(to);
}

void charts_of(const Support& support, const RayBatch& rays, ChartBatch& out) {
  Columns columns;
  if (support.dome.exists()) {
    RayBatch inside;
    BatchColumn missed;
    enter_dome(support.dome, rays, inside, missed);
    columns_inside(support, inside, columns);
    for (std::size_t i = 0; i < kSupportBatch; ++i)
      columns.chart[i] = missed[i] > 0.0 ? kMissed : columns.chart[i];
  } else {
    columns_inside(support, rays, columns);
  }
  out.c = columns.c;
  bool all = true;
  for (std::size_t i = 0; i < kSupportBatch; ++i) {
    out.chart[i] = columns.chart[i] >= 0.0 ? static_cast<std::uint8_t>(columns.chart[i]) : kNoChart;
    all = all && columns.chart[i] != kOneByOne;
  }
  for (std::size_t i = 0; !all && i < kSupportBatch; ++i) {
    if (columns.chart[i] != kOneByOne) continue;
    const auto p = support.to_chart(rays.ray(i));
    if (!p) continue;
    for (std::size_t d = 0; d < 4; ++d) out.c[d][i] = p->c[d];
    out.chart[i] = static_cast<std::uint8_t>(p->chart);
  }
}

}  // namespace lucerna
