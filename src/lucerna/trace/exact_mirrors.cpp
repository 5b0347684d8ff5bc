// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/exact_mirrors.h"

namespace lucerna {

namespace {

template <class View, class Meet>
void meet_all(const View& view, const LocalRays& rays, std::size_t n, LocalHits& hits, Meet meet) {
  for (std::size_t i = 0; i < n; ++i) {
    const ExactHit hit = meet(view, {rays.x[i], rays.y[i], rays.z[i]}, {rays.dx[i], rays.dy[i], rays.dz[i]},
                              rays.on_mirror[i] != 0);
    hits.state[i] = hit.state;
    hits.t[i] = hits.past[i] = hit.t;
    hits.start[i] = 0.0F;
    hits.gx[i] = hit.gx;
    hits.gy[i] = hit.gy;
    hits.gz[i] = hit.gz;
  }
}

}  // namespace

void meet_curve(const CurveView& curve, const LocalRays& rays, std::size_t n, LocalHits& hits) {
  meet_all(curve, rays, n, hits, [](const CurveView& v, const Vec3& o, const Vec3& d, bool on_mirror) {
    return curve_hit(v, o, d, on_mirror);
  });
}

void meet_facets(const FacetView& facets, const LocalRays& rays, std::size_t n, LocalHits& hits) {
  meet_all(facets, rays, n, hits, [](const FacetView& v, const Vec3& o, const Vec3& d, bool on_mirror) {
    return facet_hit(v, o, d, on_mirror);
  });
}

}  // namespace lucerna
