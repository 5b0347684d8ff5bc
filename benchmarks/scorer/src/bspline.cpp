// SPDX-License-Identifier: Apache-2.0
#include "bspline.h"

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace bench {

namespace {

/// Farther points are no optic, and too large for float32 to be of use.
constexpr double kFarthestMm = 1e6;
/// Of an axis of parameters, and the least share of it for a piece: others have no accurate polynomials.
constexpr double kLeastDomain = 1e-6, kLargestDomain = 1e9, kLeastShare = 1e-9;

}  // namespace

void Bspline::read_axis(const JsonNode& knots, Axis& axis) {
  axis.knots = knots.numbers();
  const auto p = static_cast<std::size_t>(axis.degree);
  if (axis.knots.size() != axis.count + p + 1)
    knots.fail(std::to_string(axis.knots.size()) + " knots",
               std::to_string(axis.count + p + 1) + " (points + degree + 1)");
  if (!std::is_sorted(axis.knots.begin(), axis.knots.end())) knots.fail("knots in ascending order");
  if (!(axis.knots[p] < axis.knots[axis.count])) knots.fail("a domain that is not empty");
  std::size_t same = 1;
  for (std::size_t i = 1; i < axis.knots.size(); ++i) {
    same = axis.knots[i] == axis.knots[i - 1] ? same + 1 : 1;
    const bool inner = axis.knots[i] > axis.knots[p] && axis.knots[i] < axis.knots[axis.count];
    if (inner && same > p)
      knots.fail(std::to_string(same) + " equal inner knots", "at most the degree: no gaps in the surface");
  }
  const double domain = axis.knots[axis.count] - axis.knots[p];
  if (!(domain >= kLeastDomain && domain <= kLargestDomain)) knots.fail("a domain from 1e-6 to 1e9 wide");
  for (std::size_t i = p; i < axis.count; ++i) {
    if (axis.knots[i] == axis.knots[i + 1]) continue;
    if (axis.knots[i + 1] - axis.knots[i] < kLeastShare * domain)
      knots.fail("a piece between knots " + std::to_string(i + 1) + " and " + std::to_string(i + 2) +
                     " of less than 1e-9 of the domain",
                 "knots that are the same, or farther apart");
    axis.breaks.push_back(axis.knots[i]);
    axis.pieces.push_back(piece(axis, i));
  }
  axis.breaks.push_back(axis.knots[axis.count]);
  axis.pieces_per_length =
      static_cast<double>(axis.pieces.size()) / (axis.breaks.back() - axis.breaks.front());
}

Bspline::Bspline(const JsonNode& s) {
  const auto degrees = s.at("degree").items();
  if (degrees.size() != 2) s.at("degree").fail("two degrees");
  const auto rows = s.at("points_mm").items();
  if (rows.empty()) s.at("points_mm").fail("rows of points");
  axes_[0].count = rows.size();
  for (const JsonNode& row : rows) {
    const auto points = row.items();
    if (axes_[1].count == 0) axes_[1].count = points.size();
    if (points.empty() || points.size() != axes_[1].count)
      row.fail(std::to_string(points.size()) + " points", "the same number > 0 in every row");
    for (const JsonNode& p : points) {
      points_.push_back(p.vector());
      const Vec3& x = points_.back();
      if (std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) > kFarthestMm)
        p.fail("coordinates within 1e6 mm");
    }
  }
  for (std::size_t a = 0; a < 2; ++a) {
    axes_[a].degree = static_cast<int>(degrees[a].whole(1, kMaxDegree));
    if (axes_[a].count <= static_cast<std::size_t>(axes_[a].degree))
      s.at("points_mm")
          .fail(std::to_string(axes_[a].count) + " points along an axis",
                "more than its degree " + std::to_string(axes_[a].degree));
    read_axis(s.at(a == 0 ? "knots_u" : "knots_v"), axes_[a]);
  }
  if (!s.has("weights")) return;
  const auto weight_rows = s.at("weights").items();
  if (weight_rows.size() != axes_[0].count)
    s.at("weights").fail(std::to_string(weight_rows.size()) + " rows of weights",
                         std::to_string(axes_[0].count));
  for (const JsonNode& row : weight_rows) {
    const auto weights = row.items();
    if (weights.size() != axes_[1].count)
      row.fail(std::to_string(weights.size()) + " weights", std::to_string(axes_[1].count));
    for (const JsonNode& w : weights) weights_.push_back(w.positive());
  }
}

// By the recursion of C. de Boor, with polynomials for numbers.
Bspline::Piece Bspline::piece(const Axis& axis, std::size_t span) {
  const auto p = static_cast<std::size_t>(axis.degree);
  const auto& k = axis.knots;
  const double low = k[span], width = k[span + 1] - low;
  Piece out;
  out.first = span - p;
  out.per_length = 1.0 / width;
  auto& c = out.powers;
  c[0][0] = 1.0;
  for (std::size_t q = 1; q <= p; ++q) {
    // Functions of degree q - 1 are span - q + 1 .. span; each goes to its two neighbours of degree q.
    const auto lower = c;
    c = {};
    for (std::size_t i = 0; i < q; ++i) {
      const double from = k[span - q + 1 + i], to = k[span + 1 + i];
      for (std::size_t power = 0; power < q; ++power) {
        const double share = lower[power][i] / (to - from);
        c[power][i] += (to - low) * share;
        c[power][i + 1] += (low - from) * share;
        c[power + 1][i] -= width * share;
        c[power + 1][i + 1] += width * share;
      }
    }
  }
  return out;
}

template <class Degree>
std::size_t Bspline::basis(const Axis& axis, Degree p, double x, Numbers& value, Numbers& slope) {
  // The piece with x in it, the last one for the end of the domain. For even knots the guess is right.
  const auto& breaks = axis.breaks;
  const double place = (x - breaks.front()) * axis.pieces_per_length;
  const auto last = static_cast<double>(axis.pieces.size() - 1);
  std::size_t k = place > 0.0 ? static_cast<std::size_t>(std::min(place, last)) : 0;
  if (x < breaks[k] || x >= breaks[k + 1])
    k = static_cast<std::size_t>(std::upper_bound(breaks.begin() + 1, breaks.end() - 1, x) - breaks.begin()) -
        1;
  const Piece& piece = axis.pieces[k];
  const double t = (x - breaks[k]) * piece.per_length;
  for (std::size_t i = 0; i <= p; ++i) {
    value[i] = piece.powers[p][i];
    slope[i] = 0.0;
  }
  for (std::size_t power = p; power-- > 0;) {
    for (std::size_t i = 0; i <= p; ++i) {
      slope[i] = slope[i] * t + value[i];
      value[i] = value[i] * t + piece.powers[power][i];
    }
  }
  for (std::size_t i = 0; i <= p; ++i) slope[i] *= piece.per_length;
  return piece.first;
}

SurfaceJet Bspline::at(double u, double v) const {
  if (!weights_.empty()) return rational(u, v);
  const auto p = static_cast<std::size_t>(axes_[0].degree), q = static_cast<std::size_t>(axes_[1].degree);
  constexpr std::integral_constant<std::size_t, 3> kCubic;
  return p == kCubic && q == kCubic ? plain(kCubic, kCubic, u, v) : plain(p, q, u, v);
}

template <class Degree>
SurfaceJet Bspline::plain(Degree p, Degree q, double u, double v) const {
  Numbers bu, du, bv, dv;
  const std::size_t i0 = basis(axes_[0], p, u, bu, du), j0 = basis(axes_[1], q, v, bv, dv);
  SurfaceJet jet;
  for (std::size_t i = 0; i <= p; ++i) {
    // A row's sums, as a function of v alone.
    Vec3 row, row_by_v;
    const Vec3* points = &points_[(i0 + i) * axes_[1].count + j0];
    for (std::size_t j = 0; j <= q; ++j) {
      row = row + bv[j] * points[j];
      row_by_v = row_by_v + dv[j] * points[j];
    }
    jet.point = jet.point + bu[i] * row;
    jet.by_u = jet.by_u + du[i] * row;
    jet.by_v = jet.by_v + bu[i] * row_by_v;
  }
  return jet;
}

SurfaceJet Bspline::rational(double u, double v) const {
  const auto p = static_cast<std::size_t>(axes_[0].degree), q = static_cast<std::size_t>(axes_[1].degree);
  Numbers bu, du, bv, dv;
  const std::size_t i0 = basis(axes_[0], p, u, bu, du), j0 = basis(axes_[1], q, v, bv, dv);
  SurfaceJet jet;
  double w = 0.0, wu = 0.0, wv = 0.0;
  for (std::size_t i = 0; i <= p; ++i) {
    for (std::size_t j = 0; j <= q; ++j) {
      const std::size_t k = (i0 + i) * axes_[1].count + j0 + j;
      const double b = bu[i] * bv[j] * weights_[k], by_u = du[i] * bv[j] * weights_[k],
                   by_v = bu[i] * dv[j] * weights_[k];
      jet.point = jet.point + b * points_[k];
      jet.by_u = jet.by_u + by_u * points_[k];
      jet.by_v = jet.by_v + by_v * points_[k];
      w += b;
      wu += by_u;
      wv += by_v;
    }
  }
  jet.point = (1.0 / w) * jet.point;
  jet.by_u = (1.0 / w) * (jet.by_u - wu * jet.point);
  jet.by_v = (1.0 / w) * (jet.by_v - wv * jet.point);
  return jet;
}

}  // namespace bench
