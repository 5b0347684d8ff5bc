// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

#include "lucerna/trace/kernels/curve_kernel.h"
#include "lucerna/trace/kernels/facet_kernel.h"
#include "lucerna/trace/kernels/kernel.h"

namespace lucerna {

// First hits with the mirrors that are no height field, ray by ray in double on their exact shape; starts of
// rays that were just reflected (`on_mirror`) are taken as rounded to float. CPU and GPU share the first two.

/// Where one ray meets such a mirror; as an entry of LocalHits.
struct ExactHit {
  std::int32_t state = kMiss;
  float t = 0.0F, gx = 0.0F, gy = 0.0F, gz = 1.0F;
};

/// Rounding of a start: a few ulp of float32 of its coordinates and of the way to them.
inline constexpr double kStartRounding = 1e-6;

LUCERNA_HD inline double larger_size(double a, double b) {
  return std::fabs(a) < std::fabs(b) ? std::fabs(b) : std::fabs(a);
}

LUCERNA_HD inline ExactHit exact_hit(double t, bool front, const Vec3& normal) {
  return {front ? kFront : kBack, static_cast<float>(t), static_cast<float>(-normal.x),
          static_cast<float>(-normal.y), static_cast<float>(normal.z)};
}

LUCERNA_HD inline ExactHit curve_hit(const CurveView& curve, const Vec3& o, const Vec3& d, bool on_mirror) {
  const CurveNode& all = curve.nodes[0];
  const double tolerance = on_mirror ? kStartRounding * (all.r1 + larger_size(all.z0, all.z1)) : 0.0;
  const CurveHit hit = CurveWalk(curve, o, d, tolerance).run();
  return hit.is_hit ? exact_hit(hit.t, hit.front, hit.normal) : ExactHit{};
}

LUCERNA_HD inline ExactHit facet_hit(const FacetView& facets, const Vec3& o, const Vec3& d, bool on_mirror) {
  const double size = facets.half_x + facets.half_y + larger_size(facets.low, facets.high);
  const FacetHit hit = intersect_facets(facets, o, d, on_mirror ? kStartRounding * size : 0.0);
  return hit.is_hit ? exact_hit(hit.t, hit.front, {-hit.dzdx, -hit.dzdy, 1.0}) : ExactHit{};
}

/// The same for the n rays of a batch.
void intersect_curve(const CurveView& curve, const LocalRays& rays, std::size_t n, LocalHits& hits);
void intersect_facets(const FacetView& facets, const LocalRays& rays, std::size_t n, LocalHits& hits);

}  // namespace lucerna
