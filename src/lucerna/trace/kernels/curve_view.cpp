// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/curve_view.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

CurveView view_of(const SweptCurve& curve, const Aperture& aperture) {
  CurveView v{};
  v.pieces = curve.pieces().data();
  v.nodes = curve.nodes().data();
  v.node_count = static_cast<std::int32_t>(curve.nodes().size());
  v.trough = curve.sweep() == Sweep::trough;
  const HeightRange z = curve.heights();
  v.overlap_mm = 1e-12 * (curve.r_max_mm() + std::max(std::abs(z.low_mm), std::abs(z.high_mm)));
  v.round = aperture.shape() == ApertureShape::circle;
  // A bulge that touches the rim does not fall off it by rounding.
  v.half_x = aperture.half_x_mm() + v.overlap_mm;
  v.half_y = aperture.half_y_mm() + v.overlap_mm;
  v.hole = aperture.hole_radius_mm();
  return v;
}

}  // namespace lucerna
