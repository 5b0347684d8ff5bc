// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "lucerna/optics/shapes/profile.h"

namespace lucerna {

/// A trough along y: the profile over |x|, the same at every y.
class TroughSurface final : public HeightSurface {
 public:
  explicit TroughSurface(std::shared_ptr<const Profile> profile);
  SurfacePoint at(double x_mm, double y_mm) const override;
  HeightRange range(const Rectangle& region) const override;
  bool convex_over(const Rectangle&) const override { return profile_->convex(); }
  const Profile& profile() const { return *profile_; }

 private:
  std::shared_ptr<const Profile> profile_;
};

}  // namespace lucerna
