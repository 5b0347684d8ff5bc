// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/exact_mirrors.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// Rounding of a start: a few ulp of float32 of its coordinates and of the way to them.
constexpr double kStartRounding = 1e-6;

void note(LocalHits& hits, std::size_t i, double t, bool front, const Vec3& normal) {
  hits.state[i] = front ? kFront : kBack;
  hits.t[i] = static_cast<float>(t);
  hits.gx[i] = static_cast<float>(-normal.x);
  hits.gy[i] = static_cast<float>(-normal.y);
  hits.gz[i] = static_cast<float>(normal.z);
}

}  // namespace

void meet_curve(const CurveView& curve, const LocalRays& rays, std::size_t n, LocalHits& hits) {
  const CurveNode& all = curve.nodes[0];
  const double slack = kStartRounding * (all.r1 + std::max(std::abs(all.z0), std::abs(all.z1)));
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 o{rays.x[i], rays.y[i], rays.z[i]}, d{rays.dx[i], rays.dy[i], rays.dz[i]};
    const CurveHit hit = CurveWalk(curve, o, d, rays.on_mirror[i] != 0 ? slack : 0.0).run();
    hits.state[i] = kMiss;
    if (hit.met) note(hits, i, hit.t, hit.front, hit.normal);
  }
}

void meet_facets(const FacetView& facets, const LocalRays& rays, std::size_t n, LocalHits& hits) {
  const double slack = kStartRounding * (facets.half_x + facets.half_y +
                                         std::max(std::abs(facets.low), std::abs(facets.high)));
  for (std::size_t i = 0; i < n; ++i) {
    const Vec3 o{rays.x[i], rays.y[i], rays.z[i]}, d{rays.dx[i], rays.dy[i], rays.dz[i]};
    const FacetHit hit = meet_facets(facets, o, d, rays.on_mirror[i] != 0 ? slack : 0.0);
    hits.state[i] = kMiss;
    if (hit.met) note(hits, i, hit.t, hit.front, {-hit.dzdx, -hit.dzdy, 1.0});
  }
}

}  // namespace lucerna
