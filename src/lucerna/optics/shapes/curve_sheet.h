// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "lucerna/optics/shapes/swept_curve.h"
#include "lucerna/reflector.h"

namespace lucerna {

/// The lowest height of a swept curve over each place: what is left of it for whoever needs a height field
/// (drawing). Between and beyond its ends it goes on level.
class CurveSheet final : public HeightSurface {
 public:
  explicit CurveSheet(std::shared_ptr<const SweptCurve> curve);
  SurfacePoint at(double x_mm, double y_mm) const override;
  HeightRange range(const Rectangle& region) const override;

 private:
  std::shared_ptr<const SweptCurve> curve_;
};

}  // namespace lucerna
