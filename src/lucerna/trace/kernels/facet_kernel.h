// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

#include "lucerna/geometry.h"
#include "lucerna/host_device.h"
#include "lucerna/optics/shapes/faceted_surface.h"

namespace lucerna {

// The first hit of a ray with a faceted mirror, one ray at a time in double: small functions that CPU and GPU
// share. Every facet is a plane or a paraboloid over its square, so hits and edges are exact.

/// A FacetedSurface within an aperture as a kernel reads it; points into the surface's table.
struct FacetView {
  const Facet* facets;  ///< row after row
  std::int32_t columns, rows;
  std::int32_t first_column, first_row;  ///< squares of the grid that the table begins with
  double pitch, curvature;
  double low, high;             ///< heights of the mirror
  bool round;                   ///< aperture: a circle of half_x, or a rectangle
  double half_x, half_y, hole;  ///< half sizes and the hole's radius
  double hair_mm;               ///< far above rounding, far below a wavelength
};

struct FacetHit {
  bool is_hit = false, front = true;
  double t = 0.0;
  double dzdx = 0.0, dzdy = 0.0;
};

/// Height of the ray over one facet: f(t) = c + t (b + t a).
struct FacetAlongRay {
  double a, b, c;
};
LUCERNA_HD inline FacetAlongRay along_ray(const FacetView& v, std::int32_t ix, std::int32_t iy, const Vec3& o,
                                          const Vec3& d) {
  const Facet& k = v.facets[iy * v.columns + ix];
  const double x = o.x - (v.first_column + ix + 0.5) * v.pitch, y = o.y - (v.first_row + iy + 0.5) * v.pitch;
  return {-0.5 * v.curvature * (d.x * d.x + d.y * d.y),
          d.z - k.dzdx * d.x - k.dzdy * d.y - v.curvature * (x * d.x + y * d.y),
          o.z - k.z_mm - k.dzdx * x - k.dzdy * y - 0.5 * v.curvature * (x * x + y * y)};
}

/// Square that holds a coordinate, within the table.
LUCERNA_HD inline std::int32_t facet_of(double x, double pitch, std::int32_t first, std::int32_t count) {
  const double i = std::floor(x / pitch) - first;
  return i < 0.0 ? 0 : (i >= count ? count - 1 : static_cast<std::int32_t>(i));
}

/// Puts a start that lies within `tolerance` of a facet a hair in front of it, and in front of the neighbours
/// that are as near: beside an edge it may have been rounded over any of them.
LUCERNA_HD inline void offset_from_facets(const FacetView& v, double tolerance, Vec3& o) {
  double min = 1e300;
  for (const double sy : {-tolerance, tolerance}) {
    for (const double sx : {-tolerance, tolerance}) {
      const std::int32_t ix = facet_of(o.x + sx, v.pitch, v.first_column, v.columns);
      const std::int32_t iy = facet_of(o.y + sy, v.pitch, v.first_row, v.rows);
      const Facet& k = v.facets[iy * v.columns + ix];
      const double f = along_ray(v, ix, iy, o, {0.0, 0.0, 0.0}).c;
      const double steep = 1.0 + std::fabs(k.dzdx) + std::fabs(k.dzdy);
      if (std::fabs(f) <= 4.0 * tolerance * steep) min = std::fmin(min, f);
    }
  }
  if (min < 1e300) o.z += v.hair_mm - min;
}

/// `tolerance_mm` > 0: the ray was just reflected here and its start is rounded by that much. A ray goes
/// through the steps between facets: they have no walls.
LUCERNA_HD inline FacetHit intersect_facets(const FacetView& v, Vec3 o, const Vec3& d, double tolerance_mm) {
  double t0 = 0.0, t1 = 1e300;
  const auto clip = [&t0, &t1](double start, double step, double low, double high) {
    if (step == 0.0) {
      if (start < low || start > high) t1 = -1.0;
      return;
    }
    const double a = (low - start) / step, b = (high - start) / step;
    t0 = std::fmax(t0, std::fmin(a, b));
    t1 = std::fmin(t1, std::fmax(a, b));
  };
  clip(o.x, d.x, -v.half_x, v.half_x);
  clip(o.y, d.y, -v.half_y, v.half_y);
  clip(o.z, d.z, v.low - tolerance_mm, v.high + tolerance_mm);
  if (!(t0 <= t1)) return {};
  if (tolerance_mm > 0.0 && t0 == 0.0) offset_from_facets(v, tolerance_mm, o);
  std::int32_t ix = facet_of(o.x + t0 * d.x, v.pitch, v.first_column, v.columns);
  std::int32_t iy = facet_of(o.y + t0 * d.y, v.pitch, v.first_row, v.rows);
  for (double t = t0; t <= t1;) {
    const std::int32_t gx = v.first_column + ix + (d.x > 0.0 ? 1 : 0),
                       gy = v.first_row + iy + (d.y > 0.0 ? 1 : 0);
    const double tx = d.x == 0.0 ? 1e300 : (gx * v.pitch - o.x) / d.x;
    const double ty = d.y == 0.0 ? 1e300 : (gy * v.pitch - o.y) / d.y;
    const double exit = std::fmax(t, std::fmin(t1, std::fmin(tx, ty)));
    const FacetAlongRay f = along_ray(v, ix, iy, o, d);
    // Roots of f, the nearer first; one if the facet is flat.
    double near = 1e301, far = 1e301;
    const double q = f.b * f.b - 4.0 * f.a * f.c;
    if (q >= 0.0) {
      const double w = -0.5 * (f.b + (f.b < 0.0 ? -std::sqrt(q) : std::sqrt(q)));
      const double r = f.a != 0.0 ? w / f.a : 1e301, s = w != 0.0 ? f.c / w : 1e301;
      near = std::fmin(r, s);
      far = std::fmax(r, s);
    }
    for (const double root : {near, far}) {
      if (!(root >= t && root <= exit)) continue;
      const double x = o.x + root * d.x, y = o.y + root * d.y, r2 = x * x + y * y;
      if (r2 < v.hole * v.hole || (v.round && r2 > v.half_x * v.half_x)) continue;
      const Facet& k = v.facets[iy * v.columns + ix];
      const double u = x - (v.first_column + ix + 0.5) * v.pitch, w = y - (v.first_row + iy + 0.5) * v.pitch;
      return {true, f.b + 2.0 * f.a * root < 0.0, root, k.dzdx + v.curvature * u, k.dzdy + v.curvature * w};
    }
    if (exit >= t1) break;
    t = exit;
    if (tx <= ty) {
      ix += d.x > 0.0 ? 1 : -1;
      if (ix < 0 || ix >= v.columns) break;
    } else {
      iy += d.y > 0.0 ? 1 : -1;
      if (iy < 0 || iy >= v.rows) break;
    }
  }
  return {};
}

}  // namespace lucerna
