// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/kernels/lens_array_walk.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "lucerna/trace/kernels/clip_line.h"

namespace lucerna {

namespace {

/// The roots of a t^2 + 2 b t + c without cancellation, in ascending order; not finite where there is none.
std::array<double, 2> roots(double a, double b, double c) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const double discriminant = b * b - a * c;
  if (!(discriminant >= 0.0)) return {kNone, kNone};
  const double q = -(b + std::copysign(std::sqrt(discriminant), b));
  const double one = q / a, other = c / q;
  return {std::fmin(one, other), std::fmax(one, other)};
}

class ArrayWalk {
 public:
  ArrayWalk(const LensArraySurface& surface, const Aperture& aperture, const Ray& ray)
      : surface_(surface), aperture_(aperture), o_(ray.origin_mm), d_(ray.direction.vec()) {}

  std::optional<LensArrayHit> run() {
    double t = 0.0, end = std::numeric_limits<double>::infinity();
    const Rectangle region = aperture_.bounds();
    const HeightRange heights = surface_.range(region);
    clip_line(o_.x, d_.x, region.x0_mm, region.x1_mm, t, end);
    clip_line(o_.y, d_.y, region.y0_mm, region.y1_mm, t, end);
    // A hair more, so that rounding at an apex or a corner loses no hit.
    const double slack = 1e-9 * (1.0 + std::abs(heights.high_mm) + std::abs(heights.low_mm));
    clip_line(o_.z, d_.z, heights.low_mm - slack, heights.high_mm + slack, t, end);
    if (!(t <= end)) return std::nullopt;
    ArrayPoint cell = surface_.cells().centre(o_.x + t * d_.x, o_.y + t * d_.y);
    while (t <= end) {
      const auto [leaves_at, step] = way_out(cell);
      const double to = std::min(leaves_at, end);
      if (const auto hit = within(cell, t, to)) return hit;
      if (!(leaves_at < end)) return std::nullopt;
      t = std::max(t, leaves_at);
      cell = {cell.x + step.x, cell.y + step.y};
    }
    return std::nullopt;
  }

 private:
  struct WayOut {
    double t;
    ArrayPoint step;
  };

  /// Through which side the ray leaves a cell: they lie half-way to the neighbours.
  WayOut way_out(const ArrayPoint& cell) const {
    WayOut out{std::numeric_limits<double>::infinity(), {}};
    for (int k = 0; k < surface_.cells().sides(); ++k) {
      const ArrayPoint& n = surface_.cells().neighbours()[static_cast<std::size_t>(k)];
      const double speed = d_.x * n.x + d_.y * n.y;
      if (!(speed > 0.0)) continue;
      const double along = (o_.x - cell.x) * n.x + (o_.y - cell.y) * n.y;
      const double t = (0.5 * (n.x * n.x + n.y * n.y) - along) / speed;
      if (t < out.t) out = {t, n};
    }
    return out;
  }

  /// The first point of the cell's lenslet on [from, to]: with w = apex - z it has rho^2 - 2 R w + (1 + k)
  /// w^2 = 0.
  std::optional<LensArrayHit> within(const ArrayPoint& cell, double from, double to) const {
    const LensArray& a = surface_.array();
    const double radius = a.radius_mm, k1 = 1.0 + a.conic;
    // From the way in on: the ray's own start may be far away.
    const double x = o_.x + from * d_.x - cell.x, y = o_.y + from * d_.y - cell.y;
    const double w = a.apex_mm - (o_.z + from * d_.z);
    const double squares = d_.x * d_.x + d_.y * d_.y + k1 * d_.z * d_.z;
    const double mixed = x * d_.x + y * d_.y + radius * d_.z - k1 * w * d_.z;
    const double rest = x * x + y * y - 2.0 * radius * w + k1 * w * w;
    for (const double root : roots(squares, mixed, rest)) {
      const double t = from + root;
      // What rounding puts just beyond a side is no less a hit of this cell.
      const double slack = 1e-12 * (1.0 + std::abs(t));
      if (!(root >= -slack && t > 0.0 && t <= to + slack)) continue;
      // Of the two sheets the one of the apex.
      if (k1 * (w - root * d_.z) / radius > 1.0) continue;
      if (!aperture_.contains(o_.x + t * d_.x, o_.y + t * d_.y)) continue;
      const double u = x + root * d_.x, v = y + root * d_.y, c = 1.0 / radius;
      const double slope = c / std::sqrt(std::max(1e-300, 1.0 - k1 * c * c * (u * u + v * v)));
      return LensArrayHit{t, Direction::from({slope * u, slope * v, 1.0})};
    }
    return std::nullopt;
  }

  const LensArraySurface& surface_;
  const Aperture& aperture_;
  Vec3 o_, d_;
};

}  // namespace

std::optional<LensArrayHit> first_lens_array_hit(const LensArraySurface& surface, const Aperture& aperture,
                                                 const Ray& ray) {
  return ArrayWalk(surface, aperture, ray).run();
}

}  // namespace lucerna
