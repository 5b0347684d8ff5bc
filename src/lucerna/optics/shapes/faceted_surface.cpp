// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/faceted_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/curve_sheet.h"
#include "lucerna/reflector.h"

namespace lucerna {

FacetedSurface::FacetedSurface(std::shared_ptr<const HeightSurface> base, double pitch_mm,
                               double pillow_radius_mm)
    : base_(std::move(base)), pitch_mm_(pitch_mm), curvature_(-1.0 / pillow_radius_mm) {
  if (dynamic_cast<const CurveSheet*>(base_.get()) != nullptr) {
    throw InputError(
        "facets: the base turns back towards the axis or is vertical; expected a profile with ascending r");
  }
  if (!(pitch_mm > 0.0 && std::isfinite(pitch_mm))) {
    throw InputError(fmt::format("facets: the pitch is {} mm, expected a finite number above 0", pitch_mm));
  }
  if (!(std::abs(pillow_radius_mm) > 0.0)) {
    throw InputError(
        fmt::format("facets: the pillows' radius is {} mm, expected any number but 0", pillow_radius_mm));
  }
}

Facet FacetedSurface::facet(std::int32_t i, std::int32_t j) const {
  const SurfacePoint c = base_->at((i + 0.5) * pitch_mm_, (j + 0.5) * pitch_mm_);
  return {c.z_mm, c.dzdx, c.dzdy};
}

SurfacePoint FacetedSurface::at(double x_mm, double y_mm) const {
  const double cx = (std::floor(x_mm / pitch_mm_) + 0.5) * pitch_mm_,
               cy = (std::floor(y_mm / pitch_mm_) + 0.5) * pitch_mm_;
  const SurfacePoint c = base_->at(cx, cy);
  const double x = x_mm - cx, y = y_mm - cy;
  return {c.z_mm + c.dzdx * x + c.dzdy * y + 0.5 * curvature_ * (x * x + y * y), c.dzdx + curvature_ * x,
          c.dzdy + curvature_ * y};
}

HeightRange FacetedSurface::range(const Rectangle& region) const {
  HeightRange all{1e300, -1e300};
  for (double j = std::floor(region.y0_mm / pitch_mm_); j * pitch_mm_ <= region.y1_mm; j += 1.0) {
    for (double i = std::floor(region.x0_mm / pitch_mm_); i * pitch_mm_ <= region.x1_mm; i += 1.0) {
      const double cx = (i + 0.5) * pitch_mm_, cy = (j + 0.5) * pitch_mm_;
      const SurfacePoint c = base_->at(cx, cy);
      // One parabola along each axis over the part of the facet that is in the region.
      const auto along = [&](double slope, double from, double to, double& low, double& high) {
        const auto f = [&](double t) { return t * (slope + 0.5 * curvature_ * t); };
        low = std::min(f(from), f(to));
        high = std::max(f(from), f(to));
        const double turn = -slope / curvature_;
        if (turn > from && turn < to) {
          low = std::min(low, f(turn));
          high = std::max(high, f(turn));
        }
      };
      const double h = 0.5 * pitch_mm_;
      double lx = 0.0, hx = 0.0, ly = 0.0, hy = 0.0;
      along(c.dzdx, std::max(region.x0_mm - cx, -h), std::min(region.x1_mm - cx, h), lx, hx);
      along(c.dzdy, std::max(region.y0_mm - cy, -h), std::min(region.y1_mm - cy, h), ly, hy);
      all.low_mm = std::min(all.low_mm, c.z_mm + lx + ly);
      all.high_mm = std::max(all.high_mm, c.z_mm + hx + hy);
    }
  }
  return all;
}

}  // namespace lucerna
