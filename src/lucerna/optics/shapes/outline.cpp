// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/outline.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "lucerna/core/io/error.h"
#include "lucerna/geometry.h"
#include "lucerna/optics/shapes/outline_curve.h"

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

/// Where the runs of an outline end, and how.
class RunEnds {
 public:
  RunEnds(std::span<const OutlinePoint> corners, double smooth_below_deg)
      : corners_(corners), smooth_below_deg_(smooth_below_deg) {}

  /// A run ends at edges and on the axis.
  bool ends_at(std::size_t i) const { return on_axis(i) || !is_smooth(i); }
  CurveEnd end_at(std::size_t i) const { return on_axis(i) && is_smooth(i) ? kOnAxis : CurveEnd{}; }
  bool on_axis(std::size_t i) const { return corners_[i % corners_.size()][0] == 0.0; }

 private:
  bool is_smooth(std::size_t i) const { return turn_deg(corners_, i % corners_.size()) <= smooth_below_deg_; }

  std::span<const OutlinePoint> corners_;
  double smooth_below_deg_;
};

using OutlineCurve = std::vector<OutlinePiece<double>>;

/// Smooth all about: what a spline's end does to it falls by four a knot, so that after 32 nothing is left.
OutlineCurve ring_through(const Points& corners) {
  constexpr std::size_t kOverlap = 32;
  const std::size_t n = corners.size();
  Points run;
  for (std::size_t i = 0; i <= n + 2 * kOverlap; ++i)
    run.push_back(corners[(i + n * kOverlap - kOverlap) % n]);
  const OutlineCurve curve = spline_through(run, {}, {});
  const auto first = curve.begin() + kOverlap;
  OutlineCurve out(first, first + static_cast<std::ptrdiff_t>(n));
  for (std::size_t i = 0; i < n; ++i) out[i].corner = i;
  return out;
}

/// All of a closed outline: a piece a side, without those along the axis.
OutlineCurve curve_through(const Points& corners, double smooth_below_deg) {
  const std::vector<OutlineRun> runs = outline_runs(corners, smooth_below_deg);
  if (runs.empty()) return ring_through(corners);
  OutlineCurve out;
  for (const OutlineRun& run : runs) {
    const OutlineCurve curve = run_curve(corners, run);
    out.insert(out.end(), curve.begin(), curve.end());
  }
  return out;
}

std::vector<OutlineSide> straight_pieces(const OutlineCurve& curve, double tolerance_mm) {
  std::vector<OutlineSide> out;
  for (const OutlinePiece<double>& c : curve) add_sides(c, straight_pieces_of(c, tolerance_mm), out);
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
  const OutlineCurve curve = curve_through(counter_clockwise(corners_mm), smooth_below_deg);
  // Whether it crosses itself is seen at a thousandth of its size: that takes the square of the pieces.
  const double coarse_mm = std::max(tolerance_mm, 1e-3 * outline_reach_mm(corners_mm));
  check_no_crossing(straight_pieces(curve, coarse_mm));
  return straight_pieces(curve, tolerance_mm);
}

std::vector<bool> sides_of_faces(std::span<const OutlinePoint> given, double smooth_below_deg,
                                 std::span<const std::size_t> sides) {
  const std::size_t n = given.size();
  const Points turned = counter_clockwise(given);
  const bool is_turned = outline_area(given) < 0.0;
  std::vector<bool> named(n, false);
  for (const std::size_t side : sides) {
    if (side >= n)
      throw InputError(fmt::format("side {} of an outline of {} sides, expected 0 to {}", side, n, n - 1));
    if (given[side][0] == 0.0 && given[(side + 1) % n][0] == 0.0)
      throw InputError(fmt::format("side {} lies on the axis and makes no face", side));
    // Side i of a reversed outline leads from corner n - 1 - i back to n - 2 - i.
    named[is_turned ? (2 * n - 2 - side) % n : side] = true;
  }
  const std::vector<OutlineRun> runs = outline_runs(turned, smooth_below_deg);
  if (runs.empty()) return std::vector<bool>(n, !sides.empty());
  std::vector<bool> out(n, false);
  for (const OutlineRun& run : runs) {
    bool any = false;
    for (std::size_t i = run.from; i < run.to; ++i) any = any || named[i % n];
    for (std::size_t i = run.from; i < run.to; ++i) out[i % n] = any;
  }
  return out;
}

std::vector<OutlineRun> outline_runs(std::span<const OutlinePoint> corners_mm, double smooth_below_deg) {
  const RunEnds ends(corners_mm, smooth_below_deg);
  const std::size_t n = corners_mm.size();
  std::size_t first = 0;
  while (first < n && !ends.ends_at(first)) ++first;
  if (first == n) return {};
  std::vector<OutlineRun> out;
  for (std::size_t from = first; from < first + n;) {
    std::size_t to = from + 1;
    while (!ends.ends_at(to)) ++to;
    const bool along_axis = to == from + 1 && ends.on_axis(from) && ends.on_axis(to);
    // A side of one piece is straight unless the axis bends it; two conditions at one piece would.
    const bool straight = to == from + 1;
    if (!along_axis)
      out.push_back(
          {from, to, straight ? CurveEnd{} : ends.end_at(from), straight ? CurveEnd{} : ends.end_at(to)});
    from = to;
  }
  return out;
}

std::vector<OutlinePiece<double>> run_curve(std::span<const OutlinePoint> corners_mm, const OutlineRun& run) {
  Points points;
  const std::size_t n = corners_mm.size();
  for (std::size_t i = run.from; i <= run.to; ++i) points.push_back(corners_mm[i % n]);
  OutlineCurve out = spline_through(points, run.start, run.end);
  for (std::size_t i = 0; i < out.size(); ++i) out[i].corner = (run.from + i) % n;
  return out;
}

int straight_pieces_of(const OutlinePiece<double>& piece, double tolerance_mm) {
  // The second derivative, linear along a cubic, is largest at an end.
  double bend = 0.0;
  for (const double u : {0.0, 1.0}) bend = std::max(bend, norm(curve_point(piece, u).second));
  constexpr double kMost = 1024.0;
  return static_cast<int>(std::clamp(std::ceil(std::sqrt(bend / (8.0 * tolerance_mm))), 1.0, kMost));
}

void add_sides(const OutlinePiece<double>& piece, int n, std::vector<OutlineSide>& sides) {
  const auto point = [&](double u) {
    const OutlinePoint p = curve_point(piece, u).at;
    return OutlinePoint{std::max(p[0], 0.0), p[1]};
  };
  const auto normal = [&](double u) {  // unit, to the right of the way
    const OutlinePoint s = curve_point(piece, u).first;
    const double all = norm(s);
    return all > 0.0 ? OutlinePoint{s[1] / all, -s[0] / all} : OutlinePoint{0.0, 0.0};
  };
  OutlinePoint from = piece.from;
  for (int k = 1; k <= n; ++k) {
    const double u = static_cast<double>(k - 1) / n, v = static_cast<double>(k) / n;
    const OutlinePoint to = k == n ? piece.to : point(v);
    if (norm(to - from) > 0.0) sides.push_back({from, to, normal(u), normal(v), piece.corner});
    from = to;
  }
}

double outline_reach_mm(std::span<const OutlinePoint> corners_mm) {
  double reach = 0.0;
  for (const OutlinePoint& c : corners_mm) reach = std::max(reach, norm(c));
  return reach;
}

}  // namespace lucerna
