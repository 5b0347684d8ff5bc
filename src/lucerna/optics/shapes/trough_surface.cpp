// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/trough_surface.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lucerna {

TroughSurface::TroughSurface(std::shared_ptr<const Profile> profile) : profile_(std::move(profile)) {}

SurfacePoint TroughSurface::at(double x_mm, double) const {
  const ProfilePoint p = profile_->at(std::abs(x_mm));
  return {p.z_mm, x_mm == 0.0 ? 0.0 : std::copysign(p.slope, x_mm * p.slope), 0.0};
}

HeightRange TroughSurface::range(const Rectangle& region) const {
  const double near = std::max({region.x0_mm, -region.x1_mm, 0.0});
  return profile_->range(near, std::max(std::abs(region.x0_mm), std::abs(region.x1_mm)));
}

}  // namespace lucerna
