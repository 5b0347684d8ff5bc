// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/mesh_tolerance.h"

#include <algorithm>
#include <cmath>

namespace lucerna {

namespace {

/// Of a box, and the least share of kOpticalTolerance's slope: STL files grow with its inverse square.
constexpr double kShareOfBox = 0.2, kLeast = 0.5;
/// What facets may change of the target.
constexpr double kMaxChange = 0.0015;
/// Standard deviation of a facet's light in one direction over the slope that it keeps: 0.42 % of a beam of 4
/// degrees at 0.3 degree (docs/benchmarks/design.md).
constexpr double kSpread = 0.45;

/// Angles of a box along u and v, seen from `mirror_mm`.
std::array<double, 2> box_deg(const TargetRectangle& rectangle, const Vec3& mirror_mm) {
  std::array<double, 2> sides{rectangle.width() / kErrorBoxes, rectangle.height() / kErrorBoxes};
  const Frame& plane = rectangle.world_from_rectangle;
  const double distance = std::abs(dot(mirror_mm - plane.origin_mm(), plane.ez()));
  for (double& side : sides) side = degrees(rectangle.is_plane ? std::atan2(side, distance) : side);
  return sides;
}

}  // namespace

double detail::change_per_deg2(const ErrorBoxes& boxes, std::span<const double> target,
                               const std::array<double, 2>& box_deg) {
  constexpr int n = kErrorBoxes;
  const auto density = [&](int u, int v) {
    const auto k = static_cast<std::size_t>(v * n + u);
    return boxes.measure()[k] > 0.0 ? target[k] / boxes.measure()[k] : 0.0;
  };
  double change2 = 0.0, norm2 = 0.0;
  for (int v = 1; v + 1 < n; ++v) {
    for (int u = 1; u + 1 < n; ++u) {
      const double here = density(u, v), measure = boxes.measure()[static_cast<std::size_t>(v * n + u)];
      const double along_u = density(u - 1, v) - 2.0 * here + density(u + 1, v);
      const double along_v = density(u, v - 1) - 2.0 * here + density(u, v + 1);
      const double bend = along_u / (box_deg[0] * box_deg[0]) + along_v / (box_deg[1] * box_deg[1]);
      change2 += measure * 0.25 * bend * bend;
      norm2 += measure * here * here;
    }
  }
  return norm2 > 0.0 ? std::sqrt(change2 / norm2) : 0.0;
}

CadTolerance mesh_tolerance(const ErrorBoxes& boxes, std::span<const double> target, const Vec3& mirror_mm) {
  CadTolerance tolerance = kOpticalTolerance;
  const std::array<double, 2> box = box_deg(boxes.rectangle(), mirror_mm);
  const double change = detail::change_per_deg2(boxes, target, box);
  const double slope_deg =
      std::min(kShareOfBox * std::min(box[0], box[1]), std::sqrt(kMaxChange / change) / kSpread);
  tolerance.slope_deg *= std::clamp(slope_deg / tolerance.slope_deg, kLeast, 1.0);
  return tolerance;
}

}  // namespace lucerna
