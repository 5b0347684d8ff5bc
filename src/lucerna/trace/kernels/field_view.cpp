// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/field_view.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

FieldView view_of(const HeightField& field, double away_mm) {
  static_assert(sizeof(FieldVertex) == 3 * sizeof(float) && sizeof(FieldNode) == 4 * sizeof(float));
  FieldView v{};
  v.vertices = &field.vertices().front().z_mm;
  v.nodes = &field.nodes().front().a;
  std::copy(field.level_offsets().begin(), field.level_offsets().end(), v.offsets);
  v.levels = static_cast<int32_t>(field.level_offsets().size());
  v.blocks = field.cells() / HeightField::kBlock;
  v.x0 = static_cast<float>(field.region().x0_mm);
  v.x1 = static_cast<float>(field.region().x1_mm);
  v.y0 = static_cast<float>(field.region().y0_mm);
  v.y1 = static_cast<float>(field.region().y1_mm);
  v.step_x = field.step_x_mm();
  v.step_y = field.step_y_mm();
  const Quadric& q = field.quadric();
  v.q0 = q.c0;
  v.qx = q.cx;
  v.qy = q.cy;
  v.qxx = q.cxx;
  v.qxy = q.cxy;
  v.qyy = q.cyy;
  v.low = static_cast<float>(field.band().low_mm);
  v.high = static_cast<float>(field.band().high_mm);
  v.rim = static_cast<float>(field.rim_mm());
  v.gradient_bound = field.gradient_bound();
  // Heights of ray and quadric are sums of a few float32 terms of this size; their rounding is about an ulp
  // each.
  const double x = std::abs(field.region().x0_mm), y = std::abs(field.region().y0_mm);
  const double extent = std::min(x, y), height = std::abs(q.at(x, y).z_mm) + std::abs(q.at(-x, y).z_mm);
  v.tolerance = static_cast<float>(4e-7 * (extent + height + away_mm));
  const auto far_x = static_cast<float>(std::max(x, std::abs(field.region().x1_mm)));
  const auto far_y = static_cast<float>(std::max(y, std::abs(field.region().y1_mm)));
  v.reach = std::abs(q.cx) * far_x + std::abs(q.cy) * far_y + std::abs(q.cxx) * far_x * far_x +
            std::abs(q.cxy) * far_x * far_y + std::abs(q.cyy) * far_y * far_y;
  v.round = field.aperture().shape() == ApertureShape::circle;
  v.half_x = static_cast<float>(field.aperture().half_x_mm());
  v.half_y = static_cast<float>(field.aperture().half_y_mm());
  v.hole = static_cast<float>(field.aperture().hole_radius_mm());
  return v;
}

FrameView view_of(const Frame& frame) {
  const auto f = [](double x) { return static_cast<float>(x); };
  const Vec3 &x = frame.ex(), &y = frame.ey(), &z = frame.ez(), &o = frame.origin_mm();
  return {{f(x.x), f(y.x), f(z.x), f(x.y), f(y.y), f(z.y), f(x.z), f(y.z), f(z.z)}, {f(o.x), f(o.y), f(o.z)}};
}

}  // namespace lucerna
