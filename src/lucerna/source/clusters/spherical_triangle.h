// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "lucerna/geometry.h"

namespace lucerna {

/// The part of the unit sphere between three great circles, smaller than a hemisphere.
struct SphericalTriangle {
  Vec3 a, b, c;  // unit vectors

  /// In steradians, > 0; exact to a few ulp also for tiny triangles (A. Van Oosterom and J. Strackee, IEEE
  /// Trans. Biomed. Eng. 30(2), 1983).
  double solid_angle_sr() const;
};

/// Uniform points of a spherical triangle, set up once (J. Arvo, "Stratified sampling of spherical
/// triangles", SIGGRAPH 1995). Thread safe.
class SphericalTriangleSampler {
 public:
  SphericalTriangleSampler() = default;
  explicit SphericalTriangleSampler(const SphericalTriangle& triangle);

  /// u, v in [0, 1); keeps areas.
  LUCERNA_HD Direction sample(double u, double v) const;
  /// 1 / pdf of what `sample` returns.
  double solid_angle_sr() const { return solid_angle_; }

 private:
  Vec3 a_, b_, c_across_a_;
  double solid_angle_ = 0.0, alpha_ = 0.0, sin_alpha_ = 0.0, cos_alpha_ = 1.0, cos_side_ = 1.0;
};

LUCERNA_HD inline Direction SphericalTriangleSampler::sample(double u, double v) const {
  // The great circle through b that cuts off the area u * solid angle beside a hits the side ac in `edge`.
  const double angle = u * solid_angle_ - alpha_;
  const double s = std::sin(angle), t = std::cos(angle);
  const double p = t - cos_alpha_, r = s + sin_alpha_ * cos_side_;
  const double denominator = (r * s + p * t) * sin_alpha_;
  double q = denominator != 0.0 ? ((r * t - p * s) * cos_alpha_ - r) / denominator : 1.0;
  q = std::clamp(q, -1.0, 1.0);
  const Vec3 edge = q * a_ + std::sqrt(1.0 - q * q) * c_across_a_;
  // On the arc from b to `edge`, uniform in the cosine. 1 - cosine from the chord keeps small arcs exact.
  const Vec3 chord = edge - b_;
  const double drop = v * 0.5 * dot(chord, chord), z = 1.0 - drop;
  const Vec3 sideways = edge - dot(edge, b_) * b_;
  const double sideways_length = length(sideways);
  if (sideways_length == 0.0) return Direction::from_unit(b_);
  return Direction::from(z * b_ + (std::sqrt(drop * (2.0 - drop)) / sideways_length) * sideways);
}

/// The hierarchical subdivision of the sphere of directions: the eight octants, each split at its edges'
/// midpoints into four, again and again. A triangle is named by a code: 3 bits of octant (bit 0 = x < 0, 1 =
/// y < 0, 2 = z < 0), then 2 bits per level (0, 1, 2 = the corner at a, b, c; 3 = the centre), left-aligned
/// to kDirectionDepth levels. Level k has 8 * 4^k triangles; at level 10 their edges are about 0.09 degrees.
inline constexpr int kDirectionDepth = 10;
inline constexpr std::uint32_t kDirectionCodes = 8u << (2 * kDirectionDepth);

/// Code of the finest triangle that holds `d`. About 0.1 us.
std::uint32_t direction_code(const Direction& d);

/// The triangle of level `depth` (0 .. kDirectionDepth) that begins at `code`.
SphericalTriangle direction_triangle(std::uint32_t code, int depth);

/// Codes that a triangle of level `depth` spans: [code, code + direction_span(depth)).
constexpr std::uint32_t direction_span(int depth) { return 1u << (2 * (kDirectionDepth - depth)); }

/// Shares of the solid angle of the four children in their parent at `code`, level `depth` < kDirectionDepth.
/// A look-up for coarse levels; below level 6, where they differ by less than 1e-3, a quarter each.
const std::array<double, 4>& direction_child_shares(std::uint32_t code, int depth);

}  // namespace lucerna
