// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/validation/bounds.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "lucerna/design/validation/direct_bound.h"
#include "lucerna/design/validation/etendue_limit.h"

namespace lucerna {

namespace {

/// Direction of the middle of a box, as near the horizon as it may be.
Direction middle(const ErrorBoxes& boxes, std::size_t b) {
  const TargetRectangle& r = boxes.rectangle();
  const double u = r.u_min + (static_cast<double>(b % kErrorBoxes) + 0.5) * r.width() / kErrorBoxes;
  const double v = r.v_min + (static_cast<double>(b / kErrorBoxes) + 0.5) * r.height() / kErrorBoxes;
  const double w = std::sqrt(std::max(0.0, 1.0 - u * u - v * v));
  return Direction::from(r.world_from_rectangle.vector({u, v, w}));
}

/// Boxes with light in the order of falling intensity.
std::vector<std::size_t> brightest_first(const ErrorBoxes& boxes, std::span<const double> target) {
  std::vector<std::size_t> order;
  for (std::size_t b = 0; b < ErrorBoxes::kInside; ++b) {
    if (boxes.measure()[b] > 0.0) order.push_back(b);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return target[a] * boxes.measure()[b] > target[b] * boxes.measure()[a];
  });
  return order;
}

double positive(double x) { return std::max(0.0, x); }

/// The least of ((p - s c)+)^2 / a + ((s d - q)+)^2 / b over s >= 0: a convex function of one number.
double min_over_scale(double p, double c, double a, double d, double q, double b) {
  const auto f = [&](double s) {
    return positive(p - s * c) * positive(p - s * c) / a + positive(s * d - q) * positive(s * d - q) / b;
  };
  if (d <= 0.0 || (c > 0.0 && p / c <= q / d)) return 0.0;
  double low = 0.0, high = c > 0.0 ? p / c : 1.0 / d;
  for (int i = 0; i < 200; ++i) {
    const double s = low + (high - low) / 3.0, t = high - (high - low) / 3.0;
    (f(s) < f(t) ? high : low) = f(s) < f(t) ? t : s;
  }
  return f(0.5 * (low + high));
}

}  // namespace

DesignBound etendue_bound(const ErrorBoxes& boxes, std::span<const double> target, TargetMode mode,
                          double share, const EtendueCurve& curve, const Vec3& axis, double opening_mm2,
                          double lateral_mm2) {
  DesignBound bound;
  if (boxes.rectangle().is_plane || curve.degenerate()) return bound;
  const std::vector<std::size_t> order = brightest_first(boxes, target);
  double total = 0.0, sr = 0.0, norm2 = 0.0;
  for (const std::size_t b : order) {
    total += target[b];
    sr += boxes.measure()[b];
    norm2 += target[b] * target[b] / boxes.measure()[b];
  }
  double part = 0.0, part_sr = 0.0, etendue = 0.0;
  for (std::size_t k = 0; k + 1 < order.size(); ++k) {
    const std::size_t b = order[k];
    part += target[b];
    part_sr += boxes.measure()[b];
    const double cosine = std::abs(dot(middle(boxes, b), axis));
    const double area = opening_mm2 * cosine + lateral_mm2 * std::sqrt(positive(1.0 - cosine * cosine));
    etendue += boxes.measure()[b] * area;
    if (k % 16 != 15) continue;
    const double max = std::min(1.0, kEtendueTolerance * share_in(curve, etendue));
    if (max >= 1.0) break;  // and more étendue holds all the more
    // By shape: s f has at most s most in the set, and the rest of s share is elsewhere.
    const double square = mode == TargetMode::absolute
                              ? positive(part - max) * positive(part - max) / part_sr
                              : min_over_scale(part, std::min(max, share), part_sr,
                                               share - std::min(max, share), total - part, sr - part_sr);
    const double error = std::sqrt(square / norm2);
    if (error > bound.error) bound = {error, error, 0.0, part / total, max, etendue};
  }
  return bound;
}

DesignBound design_bound(const ErrorBoxes& boxes, std::span<const double> target, TargetMode mode,
                         const Validation& light, SourceEtendue& etendue, const DesignShape& shape,
                         const Vec3& axis) {
  const Aperture& a = shape.aperture();
  const double share = light.error.in_rectangle.mean;
  const double lateral = 2.0 * std::hypot(a.half_x_mm(), a.half_y_mm()) * shape.height_mm();
  const auto bound = [&](const EtendueCurve& curve) {
    return etendue_bound(boxes, target, mode, share, curve, axis, opening_mm2(shape, etendue.rays()),
                         lateral);
  };
  DesignBound out = bound(etendue.quick());
  if (out.error > 0.0) out = bound(etendue.searched());
  out.direct_error = direct_light_bound(boxes, target, mode, light.replicates);
  out.error = std::max(out.etendue_error, out.direct_error);
  return out;
}

}  // namespace lucerna
