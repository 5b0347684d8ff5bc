// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "lucerna/core/math/dual.h"
#include "lucerna/optics/shapes/cubic_spline.h"
#include "lucerna/optics/shapes/outline.h"

namespace lucerna {

// The curve of an outline, piece by piece, of numbers or of numbers with their derivatives.

/// How the coordinates of a curve end there: like r and like z.
struct CurveEnd {
  SplineEnd r = SplineEnd::not_a_knot, z = SplineEnd::not_a_knot;

  friend bool operator==(const CurveEnd&, const CurveEnd&) = default;
};

/// On the axis what is smooth has an odd r and an even z.
inline constexpr CurveEnd kOnAxis{SplineEnd::natural, SplineEnd::flat};

/// A piece of a curve: cubic, by its ends and the derivatives there over 0 to 1.
template <class T>
struct OutlinePiece {
  std::array<T, 2> from, to, from_slope, to_slope;
  /// As OutlineSide has it.
  std::size_t corner = 0;
};

/// The spline through points over the length of the chords; two points are joined by a straight side.
template <class T>
std::vector<OutlinePiece<T>> spline_through(const std::vector<std::array<T, 2>>& p, CurveEnd start,
                                            CurveEnd end) {
  std::vector<T> h, delta[2], slope[2];
  for (std::size_t i = 1; i < p.size(); ++i) {
    const std::array<T, 2> way{p[i][0] - p[i - 1][0], p[i][1] - p[i - 1][1]};
    h.push_back(hypotenuse(way[0], way[1]));
    for (std::size_t k = 0; k < 2; ++k) delta[k].push_back(way[k] / h.back());
  }
  if (h.size() == 1) {
    const std::array<T, 2> way{p[1][0] - p[0][0], p[1][1] - p[0][1]};
    return {{p[0], p[1], way, way}};
  }
  slope[0] = spline_slopes(h, delta[0], start.r, end.r);
  slope[1] = spline_slopes(h, delta[1], start.z, end.z);
  std::vector<OutlinePiece<T>> out;
  for (std::size_t i = 0; i < h.size(); ++i) {
    out.push_back({p[i],
                   p[i + 1],
                   {h[i] * slope[0][i], h[i] * slope[1][i]},
                   {h[i] * slope[0][i + 1], h[i] * slope[1][i + 1]}});
  }
  return out;
}

/// A curve without edges between two corners, by their numbers; `to` goes on counting behind the last corner.
struct OutlineRun {
  std::size_t from = 0, to = 0;
  CurveEnd start, end;

  friend bool operator==(const OutlineRun&, const OutlineRun&) = default;
};

/// The runs of a counter-clockwise outline, which end at corners that turn by more than `smooth_below_deg`
/// and on the axis, without those along the axis; in order. Empty for an outline that is smooth all about.
std::vector<OutlineRun> outline_runs(std::span<const OutlinePoint> corners_mm, double smooth_below_deg);

/// The curve of a run of these corners, a piece a side, each with its corner.
std::vector<OutlinePiece<double>> run_curve(std::span<const OutlinePoint> corners_mm, const OutlineRun& run);

/// The point of a piece, the first and the second derivative there over 0 to 1.
struct CurvePoint {
  OutlinePoint at, first, second;
};
inline CurvePoint curve_point(const OutlinePiece<double>& c, double u) {
  const double v = 1.0 - u;
  CurvePoint out;
  for (std::size_t i = 0; i < 2; ++i) {
    const double way = c.to[i] - c.from[i];
    out.at[i] = v * v * (1.0 + 2.0 * u) * c.from[i] + u * u * (3.0 - 2.0 * u) * c.to[i] +
                u * v * (v * c.from_slope[i] - u * c.to_slope[i]);
    out.first[i] =
        6.0 * u * v * way + v * (1.0 - 3.0 * u) * c.from_slope[i] + u * (3.0 * u - 2.0) * c.to_slope[i];
    out.second[i] =
        6.0 * (1.0 - 2.0 * u) * way + (6.0 * u - 4.0) * c.from_slope[i] + (6.0 * u - 2.0) * c.to_slope[i];
  }
  return out;
}

/// Equal straight pieces that keep within `tolerance_mm` of a piece, 1 to 1024.
int straight_pieces_of(const OutlinePiece<double>& piece, double tolerance_mm);

/// The piece in `n` straight sides with the curve's normals; those without length are left out.
void add_sides(const OutlinePiece<double>& piece, int n, std::vector<OutlineSide>& sides);

}  // namespace lucerna
