// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/facet_mirror.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"

namespace lucerna {

FacetMirror::FacetMirror(const FacetedSurface& surface, const Aperture& aperture) {
  const double pitch = surface.pitch_mm(), hx = aperture.half_x_mm(), hy = aperture.half_y_mm();
  if (!((2.0 * hx / pitch + 2.0) * (2.0 * hy / pitch + 2.0) <= kMaxFacets)) {
    throw InputError(fmt::format(
        "facets: a pitch of {} mm makes more than {:.0f} of them, expected larger ones", pitch, kMaxFacets));
  }
  FacetView& v = view_;
  v.pitch = pitch;
  v.curvature = surface.curvature_per_mm();
  v.first_column = static_cast<std::int32_t>(std::floor(-hx / pitch));
  v.first_row = static_cast<std::int32_t>(std::floor(-hy / pitch));
  v.columns = static_cast<std::int32_t>(std::floor(hx / pitch)) + 1 - v.first_column;
  v.rows = static_cast<std::int32_t>(std::floor(hy / pitch)) + 1 - v.first_row;
  v.low = 1e300;
  v.high = -1e300;
  for (std::int32_t j = 0; j < v.rows; ++j) {
    for (std::int32_t i = 0; i < v.columns; ++i) {
      facets_.push_back(surface.facet(v.first_column + i, v.first_row + j));
      const Facet& k = facets_.back();
      const double h = 0.5 * pitch;
      const double reach = h * (std::abs(k.dzdx) + std::abs(k.dzdy)) + std::abs(v.curvature) * h * h;
      v.low = std::min(v.low, k.z_mm - reach);
      v.high = std::max(v.high, k.z_mm + reach);
    }
  }
  v.round = aperture.shape() == ApertureShape::circle;
  v.half_x = hx;
  v.half_y = hy;
  v.hole = aperture.hole_radius_mm();
  v.hair_mm = 1e-11 * (1.0 + aperture.outer_radius_mm() + std::max(std::abs(v.low), std::abs(v.high)));
}

const FacetedSurface* faceted(const Reflector& reflector) {
  return reflector.curve ? nullptr : dynamic_cast<const FacetedSurface*>(reflector.surface.get());
}

}  // namespace lucerna
