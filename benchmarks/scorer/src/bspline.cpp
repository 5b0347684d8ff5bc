// SPDX-License-Identifier: Apache-2.0
#include "bspline.h"

#include <algorithm>
#include <cmath>

namespace bench {

namespace {

/// Farther points are no optic, and too large for float32 to be of use.
constexpr double kFarthestMm = 1e6;

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
  for (std::size_t i = p; i < axis.count; ++i) {
    if (axis.knots[i] == axis.knots[i + 1]) continue;
    axis.breaks.push_back(axis.knots[i]);
    axis.pieces.push_back(piece(axis, i));
  }
  axis.breaks.push_back(axis.knots[axis.count]);
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
  for (const JsonNode& row : s.at("weights").items()) {
    for (const JsonNode& w : row.items()) weights_.push_back(w.positive());
  }
  if (weights_.size() != points_.size())
    s.at("weights").fail(std::to_string(weights_.size()) + " weights", std::to_string(points_.size()));
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

std::size_t Bspline::basis(const Axis& axis, double x, Numbers& value, Numbers& slope) {
  const auto p = static_cast<std::size_t>(axis.degree);
  // The piece with x in it, the last one for the end of the domain.
  const auto above = std::upper_bound(axis.breaks.begin() + 1, axis.breaks.end() - 1, x);
  const auto k = static_cast<std::size_t>(above - axis.breaks.begin()) - 1;
  const Piece& piece = axis.pieces[k];
  const double t = (x - axis.breaks[k]) * piece.per_length;
  value = piece.powers[p];
  slope.fill(0.0);
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
  Numbers bu, du, bv, dv;
  const std::size_t i0 = basis(axes_[0], u, bu, du), j0 = basis(axes_[1], v, bv, dv);
  const auto p = static_cast<std::size_t>(axes_[0].degree), q = static_cast<std::size_t>(axes_[1].degree);
  SurfaceJet jet;
  double w = 0.0, wu = 0.0, wv = 0.0;
  for (std::size_t i = 0; i <= p; ++i) {
    // A row's sums, as a function of v alone.
    Vec3 row, row_by_v;
    double weight = 0.0, weight_by_v = 0.0;
    const std::size_t k0 = (i0 + i) * axes_[1].count + j0;
    for (std::size_t j = 0; j <= q; ++j) {
      double b = bv[j], slope = dv[j];
      if (!weights_.empty()) {
        b *= weights_[k0 + j];
        slope *= weights_[k0 + j];
        weight += b;
        weight_by_v += slope;
      }
      row = row + b * points_[k0 + j];
      row_by_v = row_by_v + slope * points_[k0 + j];
    }
    jet.point = jet.point + bu[i] * row;
    jet.by_u = jet.by_u + du[i] * row;
    jet.by_v = jet.by_v + bu[i] * row_by_v;
    w += bu[i] * weight;
    wu += du[i] * weight;
    wv += bu[i] * weight_by_v;
  }
  if (weights_.empty()) return jet;
  jet.point = (1.0 / w) * jet.point;
  jet.by_u = (1.0 / w) * (jet.by_u - wu * jet.point);
  jet.by_v = (1.0 / w) * (jet.by_v - wv * jet.point);
  return jet;
}

}  // namespace bench
