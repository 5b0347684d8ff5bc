// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/swept_curve.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/optics/shapes/cubic_spline.h"

namespace lucerna {

namespace {

/// Pieces turn by less than this, radians: then a piece along its steeper coordinate is monotone in it, and a
/// ray hits it at most twice but for grazing.
constexpr double kMaxTurn = 0.1;
/// Halvings of one interval between points.
constexpr int kMaxHalvings = 10;

double value(const double (&k)[4], double s) { return k[0] + s * (k[1] + s * (k[2] + s * k[3])); }
double slope(const double (&k)[4], double s) { return k[1] + s * (2.0 * k[2] + 3.0 * s * k[3]); }

/// The same cubic over [a, a + w].
void restrict_to(double (&k)[4], double a, double w) {
  const double c0 = value(k, a), c1 = slope(k, a), c2 = k[2] + 3.0 * a * k[3];
  k[0] = c0;
  k[1] = w * c1;
  k[2] = w * w * c2;
  k[3] = w * w * w * k[3];
}

/// Bounds of a cubic over [0, 1]: its Bezier ordinates.
HeightRange bounds(const double (&k)[4]) {
  const double b[4] = {k[0], k[0] + k[1] / 3.0, k[0] + (2.0 * k[1] + k[2]) / 3.0, k[0] + k[1] + k[2] + k[3]};
  const auto [low, high] = std::minmax_element(b, b + 4);
  return {*low, *high};
}

/// An upper bound on the angle between any two tangents: from the control polygon of the derivative.
double turn_of(const CurvePiece& p) {
  const auto leg = [&](const double(&k)[4], int i) {
    return i == 0 ? k[1] : (i == 1 ? k[1] + k[2] : k[1] + 2.0 * k[2] + 3.0 * k[3]);
  };
  double max = 0.0;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < i; ++j) {
      const double ar = leg(p.r, i), az = leg(p.z, i), br = leg(p.r, j), bz = leg(p.z, j);
      max = std::max(max, std::abs(std::atan2(ar * bz - az * br, ar * br + az * bz)));
    }
  }
  return max;
}

void check_knots(const std::vector<ProfileKnot>& knots) {
  if (knots.size() < 2) {
    throw InputError(
        fmt::format("reflector: the profile has {} point(s), expected at least 2", knots.size()));
  }
  bool off_axis = false;
  for (std::size_t i = 0; i < knots.size(); ++i) {
    const ProfileKnot& k = knots[i];
    if (!std::isfinite(k.r_mm) || !std::isfinite(k.z_mm) || k.r_mm < 0.0) {
      throw InputError(
          fmt::format("reflector: profile point {} is [{}, {}], expected finite numbers with r >= 0", i + 1,
                      k.r_mm, k.z_mm));
    }
    if (i > 0 && k.r_mm == knots[i - 1].r_mm && k.z_mm == knots[i - 1].z_mm) {
      throw InputError(fmt::format("reflector: profile points {} and {} are the same, [{}, {}]", i, i + 1,
                                   k.r_mm, k.z_mm));
    }
    off_axis = off_axis || k.r_mm > 0.0;
  }
  if (!off_axis) throw InputError("reflector: all points of the profile lie on the axis");
}

}  // namespace

SweptCurve::SweptCurve(const std::vector<ProfileKnot>& knots, Sweep sweep) : sweep_(sweep) {
  check_knots(knots);
  first_ = knots.front();
  last_ = knots.back();
  const std::size_t m = knots.size() - 1;
  std::vector<double> h(m), dr(m), dz(m);
  for (std::size_t i = 0; i < m; ++i) {
    h[i] = std::hypot(knots[i + 1].r_mm - knots[i].r_mm, knots[i + 1].z_mm - knots[i].z_mm);
    dr[i] = (knots[i + 1].r_mm - knots[i].r_mm) / h[i];
    dz[i] = (knots[i + 1].z_mm - knots[i].z_mm) / h[i];
  }
  // On the axis r is odd and z even, so that the swept surface is smooth there.
  const bool starts = first_.r_mm == 0.0, ends = last_.r_mm == 0.0;
  std::vector<double> sr{dr[0], dr[0]}, sz{dz[0], dz[0]};
  if (m > 1) {
    const auto end = [](bool on_axis, SplineEnd there) { return on_axis ? there : SplineEnd::not_a_knot; };
    sr = spline_slopes(h, dr, end(starts, SplineEnd::natural), end(ends, SplineEnd::natural));
    sz = spline_slopes(h, dz, end(starts, SplineEnd::flat), end(ends, SplineEnd::flat));
  }
  for (std::size_t i = 0; i < m; ++i) {
    CurvePiece p{};
    const auto hermite = [&](double(&k)[4], double a, double secant, double s0, double s1) {
      k[0] = a;
      k[1] = h[i] * s0;
      k[2] = h[i] * (3.0 * secant - 2.0 * s0 - s1);
      k[3] = h[i] * (s0 + s1 - 2.0 * secant);
    };
    hermite(p.r, knots[i].r_mm, dr[i], sr[i], sr[i + 1]);
    hermite(p.z, knots[i].z_mm, dz[i], sz[i], sz[i + 1]);
    add_pieces(p, i, 0);
  }
  // Neighbours end and start at the same numbers, to the bit.
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    CurvePiece& p = pieces_[i];
    const bool last = i + 1 == pieces_.size();
    const double r1 = last ? last_.r_mm : pieces_[i + 1].r[0], z1 = last ? last_.z_mm : pieces_[i + 1].z[0];
    p.along_z = std::abs(z1 - p.z[0]) > std::abs(r1 - p.r[0]);
    p.from = p.along_z ? p.z[0] : p.r[0];
    p.to = p.along_z ? z1 : r1;
    const double tolerance = 1e-9 * (std::abs(r1) + std::abs(p.r[0]) + h[knot_of_[i]]);
    if (bounds(p.r).low_mm < -tolerance) {
      throw InputError(
          fmt::format("reflector: the profile swings over the axis between points {} and {}; "
                      "expected points closer together",
                      knot_of_[i] + 1, knot_of_[i] + 2));
    }
  }
  add_nodes(0, pieces_.size());
  check_crossings();
}

void SweptCurve::add_pieces(const CurvePiece& whole, std::size_t knot, int depth) {
  if (turn_of(whole) < kMaxTurn) {
    pieces_.push_back(whole);
    knot_of_.push_back(knot);
    return;
  }
  if (depth == kMaxHalvings) {
    throw InputError(
        fmt::format("reflector: the profile turns on the spot between points {} and {}; "
                    "expected a smooth row of points",
                    knot + 1, knot + 2));
  }
  for (const double a : {0.0, 0.5}) {
    CurvePiece half = whole;
    restrict_to(half.r, a, 0.5);
    restrict_to(half.z, a, 0.5);
    add_pieces(half, knot, depth + 1);
  }
}

std::int32_t SweptCurve::add_nodes(std::size_t first, std::size_t last) {
  const auto here = static_cast<std::size_t>(nodes_.size());
  nodes_.push_back({1e300, -1e300, 1e300, -1e300, 0, -1});
  CurveNode box = nodes_[here];
  const auto widen = [&box](double r0, double r1, double z0, double z1) {
    box.r0 = std::min(box.r0, r0);
    box.r1 = std::max(box.r1, r1);
    box.z0 = std::min(box.z0, z0);
    box.z1 = std::max(box.z1, z1);
  };
  if (last - first == 1) {
    const HeightRange r = bounds(pieces_[first].r), z = bounds(pieces_[first].z);
    widen(std::max(0.0, r.low_mm), r.high_mm, z.low_mm, z.high_mm);
    box.piece = static_cast<std::int32_t>(first);
  } else {
    const std::size_t middle = first + (last - first) / 2;
    for (const auto& [a, b] : {std::pair{first, middle}, std::pair{middle, last}}) {
      const CurveNode child = nodes_[static_cast<std::size_t>(add_nodes(a, b))];
      widen(child.r0, child.r1, child.z0, child.z1);
    }
  }
  box.skip = static_cast<std::int32_t>(nodes_.size());
  nodes_[here] = box;
  return static_cast<std::int32_t>(here);
}

void SweptCurve::check_crossings() const {
  // Chords of the pieces: with pieces that turn so little, a crossing of curves is one of chords but where
  // they nearly touch.
  const auto side = [](const CurvePiece& a, double r1, double z1, double r, double z) {
    return (r1 - a.r[0]) * (z - a.z[0]) - (z1 - a.z[0]) * (r - a.r[0]);
  };
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const CurvePiece& p = pieces_[i];
    const double pr = value(p.r, 1.0), pz = value(p.z, 1.0);
    const HeightRange r = bounds(p.r), z = bounds(p.z);
    for (std::size_t n = 0; n < nodes_.size();) {
      const CurveNode& node = nodes_[n];
      const bool apart =
          node.r0 > r.high_mm || node.r1 < r.low_mm || node.z0 > z.high_mm || node.z1 < z.low_mm;
      if (apart || (node.piece >= 0 && node.piece < static_cast<std::int32_t>(i) + 2)) {
        n = static_cast<std::size_t>(apart ? node.skip : static_cast<std::int32_t>(n) + 1);
        continue;
      }
      ++n;
      if (node.piece < 0) continue;
      const auto k = static_cast<std::size_t>(node.piece);
      const CurvePiece& q = pieces_[k];
      const double qr = value(q.r, 1.0), qz = value(q.z, 1.0);
      const double a = side(p, pr, pz, q.r[0], q.z[0]), b = side(p, pr, pz, qr, qz);
      const double c = side(q, qr, qz, p.r[0], p.z[0]), d = side(q, qr, qz, pr, pz);
      if ((a > 0.0) == (b > 0.0) || (c > 0.0) == (d > 0.0)) continue;
      throw InputError(
          fmt::format("reflector: the profile crosses itself: between points {} and {} it intersects "
                      "what lies between points {} and {}, near [{:.6g}, {:.6g}]",
                      knot_of_[i] + 1, knot_of_[i] + 2, knot_of_[k] + 1, knot_of_[k] + 2, p.r[0], p.z[0]));
    }
  }
}

SweptCurve::Point SweptCurve::at(double u) const {
  const double place = std::clamp(u, 0.0, 1.0) * static_cast<double>(pieces_.size());
  const std::size_t i = std::min(static_cast<std::size_t>(place), pieces_.size() - 1);
  const CurvePiece& p = pieces_[i];
  const double s = place - static_cast<double>(i);
  const double r = slope(p.r, s), z = slope(p.z, s), length = std::hypot(r, z);
  return {value(p.r, s), value(p.z, s), -z / length, r / length};
}

}  // namespace lucerna
