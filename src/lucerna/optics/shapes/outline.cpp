// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/cubic_spline.h"

namespace lucerna {

namespace {

using Points = std::vector<OutlinePoint>;

OutlinePoint operator-(const OutlinePoint& a, const OutlinePoint& b) { return {a[0] - b[0], a[1] - b[1]}; }

double norm(const OutlinePoint& a) { return std::hypot(a[0], a[1]); }

/// Twice the area of a polygon; above 0 where it runs counter-clockwise with z up and r to the right.
double outline_area(std::span<const OutlinePoint> p) {
  double sum = 0.0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    const OutlinePoint &a = p[i], &b = p[(i + 1) % p.size()];
    sum += a[0] * b[1] - b[0] * a[1];
  }
  return sum;
}

/// On which side of the line from a to b c lies.
double side_of(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool cross_each_other(const OutlinePoint& a, const OutlinePoint& b, const OutlinePoint& c,
                      const OutlinePoint& d) {
  return side_of(a, b, c) * side_of(a, b, d) < 0.0 && side_of(c, d, a) * side_of(c, d, b) < 0.0;
}

/// The first two sides of a closed polygon that cross each other.
std::optional<std::pair<std::size_t, std::size_t>> first_crossing(std::span<const OutlinePoint> p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t k = i + 2; k < n; ++k) {
      if (cross_each_other(p[i], p[(i + 1) % n], p[k], p[(k + 1) % n])) return std::pair{i, k};
    }
  }
  return std::nullopt;
}

/// A piece of a curve: cubic, by its ends and the derivatives there over 0 to 1.
struct CubicPiece {
  OutlinePoint from, to, from_slope, to_slope;

  OutlinePoint at(double u) const {
    const double v = 1.0 - u;
    OutlinePoint out;
    for (std::size_t i = 0; i < 2; ++i) {
      out[i] = v * v * (1.0 + 2.0 * u) * from[i] + u * u * (3.0 - 2.0 * u) * to[i] +
               u * v * (v * from_slope[i] - u * to_slope[i]);
    }
    return {std::max(out[0], 0.0), out[1]};
  }

  OutlinePoint slope(double u) const {
    const double v = 1.0 - u;
    OutlinePoint out;
    for (std::size_t i = 0; i < 2; ++i) {
      out[i] = 6.0 * u * v * (to[i] - from[i]) + v * (1.0 - 3.0 * u) * from_slope[i] +
               u * (3.0 * u - 2.0) * to_slope[i];
    }
    return out;
  }

  /// Unit, to the right of the way.
  OutlinePoint normal(double u) const {
    const OutlinePoint s = slope(u);
    const double all = norm(s);
    if (!(all > 0.0)) return {0.0, 0.0};
    return {s[1] / all, -s[0] / all};
  }

  /// Straight pieces that keep within `tolerance_mm`: the second derivative, linear along a cubic, is largest
  /// at an end.
  int pieces(double tolerance_mm) const {
    double bend = 0.0;
    for (const bool at_end : {false, true}) {
      OutlinePoint second;
      for (std::size_t i = 0; i < 2; ++i) {
        const double all = 6.0 * (to[i] - from[i]);
        second[i] = at_end ? -all + 2.0 * from_slope[i] + 4.0 * to_slope[i]
                           : all - 4.0 * from_slope[i] - 2.0 * to_slope[i];
      }
      bend = std::max(bend, norm(second));
    }
    constexpr double kMost = 1024.0;
    return static_cast<int>(std::clamp(std::ceil(std::sqrt(bend / (8.0 * tolerance_mm))), 1.0, kMost));
  }
};

/// How the coordinates of a curve end there: like r and like z.
struct CurveEnd {
  SplineEnd r = SplineEnd::not_a_knot, z = SplineEnd::not_a_knot;
};

/// On the axis what is smooth has an odd r and an even z.
constexpr CurveEnd kOnAxis{SplineEnd::natural, SplineEnd::flat};

/// The spline through points over the length of the chords.
std::vector<CubicPiece> spline_through(const Points& p, CurveEnd start, CurveEnd end) {
  std::vector<double> h, delta[2], slope[2];
  for (std::size_t i = 1; i < p.size(); ++i) {
    const OutlinePoint way = p[i] - p[i - 1];
    h.push_back(norm(way));
    for (std::size_t k = 0; k < 2; ++k) delta[k].push_back(way[k] / h.back());
  }
  if (h.size() == 1) {
    return {{p[0], p[1], p[1] - p[0], p[1] - p[0]}};
  }
  slope[0] = spline_slopes(h, delta[0], start.r, end.r);
  slope[1] = spline_slopes(h, delta[1], start.z, end.z);
  std::vector<CubicPiece> out;
  for (std::size_t i = 0; i < h.size(); ++i) {
    out.push_back({p[i],
                   p[i + 1],
                   {h[i] * slope[0][i], h[i] * slope[1][i]},
                   {h[i] * slope[0][i + 1], h[i] * slope[1][i + 1]}});
  }
  return out;
}

/// All of a closed outline: a piece a side, without those along the axis.
class Curves {
 public:
  Curves(Points corners, double smooth_below_deg)
      : corners_(std::move(corners)), smooth_below_deg_(smooth_below_deg) {
    std::size_t first = 0;
    while (first < corners_.size() && !ends_at(first)) ++first;
    if (first == corners_.size()) {
      add_ring();
    } else {
      std::rotate(corners_.begin(), corners_.begin() + static_cast<std::ptrdiff_t>(first), corners_.end());
      add_runs();
    }
  }

  std::vector<CubicPiece> pieces;

 private:
  const OutlinePoint& corner(std::size_t i) const { return corners_[i % corners_.size()]; }

  /// A run ends at edges and on the axis.
  bool ends_at(std::size_t i) const {
    return corner(i)[0] == 0.0 || turn_deg(corners_, i % corners_.size()) > smooth_below_deg_;
  }

  CurveEnd end_at(std::size_t i) const {
    const bool smooth = corner(i)[0] == 0.0 && turn_deg(corners_, i % corners_.size()) <= smooth_below_deg_;
    return smooth ? kOnAxis : CurveEnd{};
  }

  void add_runs() {
    for (std::size_t from = 0; from < corners_.size();) {
      std::size_t to = from + 1;
      while (!ends_at(to)) ++to;
      if (to > from + 1 || corner(from)[0] > 0.0 || corner(to)[0] > 0.0) add_run(from, to);
      from = to;
    }
  }

  void add_run(std::size_t from, std::size_t to) {
    Points run;
    for (std::size_t i = from; i <= to; ++i) run.push_back(corner(i));
    // A side of one piece is straight unless the axis bends it; two conditions at one piece would.
    const std::vector<CubicPiece> curve =
        run.size() == 2 ? spline_through(run, {}, {}) : spline_through(run, end_at(from), end_at(to));
    pieces.insert(pieces.end(), curve.begin(), curve.end());
  }

  /// Smooth all about: what a spline's end does to it falls by four a knot, so that after 32 nothing is left.
  void add_ring() {
    constexpr std::size_t kOverlap = 32;
    const std::size_t n = corners_.size();
    Points run;
    for (std::size_t i = 0; i <= n + 2 * kOverlap; ++i) run.push_back(corner(i + n * kOverlap - kOverlap));
    const std::vector<CubicPiece> curve = spline_through(run, {}, {});
    const auto first = curve.begin() + kOverlap;
    pieces.assign(first, first + static_cast<std::ptrdiff_t>(n));
  }

  Points corners_;
  double smooth_below_deg_;
};

std::vector<OutlineSide> straight_pieces(const std::vector<CubicPiece>& curve, double tolerance_mm) {
  std::vector<OutlineSide> out;
  for (const CubicPiece& c : curve) {
    const int n = c.pieces(tolerance_mm);
    OutlinePoint from = c.from;
    for (int k = 1; k <= n; ++k) {
      const double u = static_cast<double>(k - 1) / n, v = static_cast<double>(k) / n;
      const OutlinePoint to = k == n ? c.to : c.at(v);
      if (norm(to - from) > 0.0) out.push_back({from, to, c.normal(u), c.normal(v)});
      from = to;
    }
  }
  return out;
}

void check_no_crossing(const std::vector<OutlineSide>& sides) {
  Points p;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    p.push_back(sides[i].from);
    if (sides[i].to != sides[(i + 1) % sides.size()].from) p.push_back(sides[i].to);
  }
  const auto found = first_crossing(p);
  if (!found) return;
  const OutlinePoint& at = p[found->first];
  throw InputError(
      fmt::format("the curve through the outline's corners crosses itself at [{:.6g}, {:.6g}]; expected more "
                  "corners there, or a smaller smooth_below_deg",
                  at[0], at[1]));
}

}  // namespace

void check_outline(std::span<const OutlinePoint> p) {
  if (p.size() < 3) throw InputError(fmt::format("outline of {} corners, expected at least 3", p.size()));
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    if (!std::isfinite(p[i][0]) || !std::isfinite(p[i][1]) || p[i][0] < 0.0) {
      throw InputError(
          fmt::format("corner {} of the outline is [{}, {}], expected a radius >= 0 and a height", i + 1,
                      p[i][0], p[i][1]));
    }
    if (p[i] == p[(i + 1) % n])
      throw InputError(fmt::format("corners {} and {} of the outline are equal", i + 1, (i + 1) % n + 1));
  }
  if (const auto found = first_crossing(p)) {
    throw InputError(fmt::format("the outline crosses itself between corners {} and {} and after corner {}",
                                 found->first + 1, found->first + 2, found->second + 1));
  }
  if (outline_area(p) == 0.0) throw InputError("the outline has no area");
}

std::vector<OutlinePoint> counter_clockwise(std::span<const OutlinePoint> corners_mm) {
  Points out(corners_mm.begin(), corners_mm.end());
  if (outline_area(out) < 0.0) std::reverse(out.begin(), out.end());
  return out;
}

double turn_deg(std::span<const OutlinePoint> p, std::size_t i) {
  const OutlinePoint &before = p[(i + p.size() - 1) % p.size()], &at = p[i], &after = p[(i + 1) % p.size()];
  if (at[0] == 0.0) {
    const OutlinePoint& side = before[0] > 0.0 ? before : after;
    return 2.0 * degrees(std::atan2(std::abs(side[1] - at[1]), side[0]));
  }
  const double in = std::atan2(at[1] - before[1], at[0] - before[0]);
  const double out = std::atan2(after[1] - at[1], after[0] - at[0]);
  return std::abs(degrees(std::remainder(out - in, 2.0 * std::numbers::pi)));
}

std::vector<OutlineSide> outline_sides(std::span<const OutlinePoint> corners_mm, double smooth_below_deg,
                                       double tolerance_mm) {
  check_outline(corners_mm);
  const Curves curves(counter_clockwise(corners_mm), smooth_below_deg);
  // Whether it crosses itself is seen at a thousandth of its size: that takes the square of the pieces.
  const double coarse_mm = std::max(tolerance_mm, 1e-3 * outline_reach_mm(corners_mm));
  check_no_crossing(straight_pieces(curves.pieces, coarse_mm));
  return straight_pieces(curves.pieces, tolerance_mm);
}

double outline_reach_mm(std::span<const OutlinePoint> corners_mm) {
  double reach = 0.0;
  for (const OutlinePoint& c : corners_mm) reach = std::max(reach, norm(c));
  return reach;
}

}  // namespace lucerna
