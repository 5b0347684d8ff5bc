// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/trace/curve_view.h"
#include "lucerna/trace/facet_mirror.h"
#include "lucerna/trace/kernel.h"

namespace lucerna {

// First hits of a batch with the mirrors that are no height field, ray by ray in double on their exact shape;
// starts of rays that were just reflected (LocalRays::on_mirror) are taken as rounded to float.

void meet_curve(const CurveView& curve, const LocalRays& rays, std::size_t n, LocalHits& hits);
void meet_facets(const FacetView& facets, const LocalRays& rays, std::size_t n, LocalHits& hits);

}  // namespace lucerna
