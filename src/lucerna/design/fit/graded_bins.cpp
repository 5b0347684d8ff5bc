// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/graded_bins.h"

#include <algorithm>

namespace lucerna {

namespace {

/// Direction cosines beyond which bins are slivers along the horizon.
constexpr double kMaxCosine = 0.99;
/// How far bins of a plane reach beyond its rectangle, over the rectangle's side.
constexpr double kPlaneReach = 2.0;

TentAxis graded_axis(double low, double high, int inner, double widen, int outer, bool is_plane) {
  const double middle = 0.5 * (low + high), half = 0.5 * widen * (high - low);
  if (is_plane) {
    const double far = half + kPlaneReach * (high - low);
    return tent_axis(middle - half, middle + half, inner, outer, middle - far, middle + far);
  }
  return tent_axis(std::max(-kMaxCosine, middle - half), std::min(kMaxCosine, middle + half), inner, outer,
                   -1.0, 1.0);
}

}  // namespace

TentBins graded_bins(const TargetRectangle& rectangle, const Frame& mirror_from_world, int inner,
                     double widen, int outer) {
  const bool plane = rectangle.is_plane;
  const TentAxis u = graded_axis(rectangle.u_min, rectangle.u_max, inner, widen, outer, plane);
  const TentAxis v = graded_axis(rectangle.v_min, rectangle.v_max, inner, widen, outer, plane);
  const Frame axes = mirror_from_world * rectangle.world_from_rectangle;
  if (plane) return TentBins::graded_plane(axes, 1.0, 1.0, u, v);
  return TentBins::graded(Frame(axes.ex(), axes.ey(), axes.ez(), {}), u, v);
}

Eigen::VectorXd in_rectangle(const TentBins& bins, const TargetRectangle& rectangle) {
  const auto n = static_cast<std::size_t>(bins.count());
  Eigen::VectorXd inside(static_cast<Eigen::Index>(bins.size()));
  const auto between = [](const TentAxis& axis, std::size_t i, double low, double high) {
    double slope = 0.0;
    const double at = axis.coordinate(static_cast<double>(i) + 0.5, slope);
    return at > low && at < high;
  };
  for (std::size_t b = 0; b < bins.size(); ++b) {
    const bool in = between(bins.view().axis_u, b % n, rectangle.u_min, rectangle.u_max) &&
                    between(bins.view().axis_v, b / n, rectangle.v_min, rectangle.v_max);
    inside[static_cast<Eigen::Index>(b)] = in ? 1.0 : 0.0;
  }
  return inside;
}

}  // namespace lucerna
