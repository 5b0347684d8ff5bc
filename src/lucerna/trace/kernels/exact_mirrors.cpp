// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/exact_mirrors.h"

namespace lucerna {

namespace {

template <class View, class Intersect>
void intersect_all(const View& view, const LocalRays& rays, std::size_t n, LocalHits& hits,
                   Intersect intersect) {
  for (std::size_t i = 0; i < n; ++i) {
    const ExactHit hit = intersect(view, {rays.x[i], rays.y[i], rays.z[i]},
                                   {rays.dx[i], rays.dy[i], rays.dz[i]}, rays.on_mirror[i] != 0);
    hits.state[i] = hit.state;
    hits.t[i] = hits.past[i] = hit.t;
    hits.start[i] = 0.0F;
    hits.gx[i] = hit.gx;
    hits.gy[i] = hit.gy;
    hits.gz[i] = hit.gz;
  }
}

}  // namespace

void intersect_curve(const CurveView& curve, const LocalRays& rays, std::size_t n, LocalHits& hits) {
  intersect_all(curve, rays, n, hits, [](const CurveView& v, const Vec3& o, const Vec3& d, bool on_mirror) {
    return curve_hit(v, o, d, on_mirror);
  });
}

void intersect_facets(const FacetView& facets, const LocalRays& rays, std::size_t n, LocalHits& hits) {
  intersect_all(facets, rays, n, hits, [](const FacetView& v, const Vec3& o, const Vec3& d, bool on_mirror) {
    return facet_hit(v, o, d, on_mirror);
  });
}

}  // namespace lucerna
