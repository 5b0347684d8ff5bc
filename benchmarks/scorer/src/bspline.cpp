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

std::vector<double> Bspline::breaks(std::size_t axis) const {
  std::vector<double> out;
  for (const double k : axes_[axis].knots) {
    if (k >= low(axis) && k <= high(axis) && (out.empty() || k > out.back())) out.push_back(k);
  }
  return out;
}

std::size_t Bspline::basis(const Axis& axis, double x, Basis& value, Basis& slope) {
  const auto p = static_cast<std::size_t>(axis.degree);
  const auto& k = axis.knots;
  const auto first = k.begin() + static_cast<std::ptrdiff_t>(p);
  const auto last = k.begin() + static_cast<std::ptrdiff_t>(axis.count);
  // The piece [k[span], k[span + 1]) with x in it, the last one for the end of the domain.
  const auto above = std::upper_bound(first, last, x);
  auto span = static_cast<std::size_t>(above - k.begin()) - 1;
  while (span > p && k[span] == k[span + 1]) --span;
  value.fill(0.0);
  slope.fill(0.0);
  value[0] = 1.0;
  for (std::size_t q = 1; q <= p; ++q) {
    // Functions of degree q - 1 are span - q + 1 .. span; each goes to its two neighbours of degree q.
    const Basis lower = value;
    value.fill(0.0);
    for (std::size_t i = 0; i < q; ++i) {
      const double from = k[span - q + 1 + i], to = k[span + 1 + i], share = lower[i] / (to - from);
      value[i] += (to - x) * share;
      value[i + 1] += (x - from) * share;
      if (q == p) {
        slope[i] -= static_cast<double>(p) * share;
        slope[i + 1] += static_cast<double>(p) * share;
      }
    }
  }
  return span - p;
}

SurfaceJet Bspline::at(double u, double v) const {
  Basis bu, du, bv, dv;
  const std::size_t i0 = basis(axes_[0], u, bu, du), j0 = basis(axes_[1], v, bv, dv);
  SurfaceJet jet;
  double w = 0.0, wu = 0.0, wv = 0.0;
  for (std::size_t i = 0; i <= static_cast<std::size_t>(axes_[0].degree); ++i) {
    for (std::size_t j = 0; j <= static_cast<std::size_t>(axes_[1].degree); ++j) {
      const std::size_t k = (i0 + i) * axes_[1].count + j0 + j;
      const double weight = weights_.empty() ? 1.0 : weights_[k];
      const double b = weight * bu[i] * bv[j], bdu = weight * du[i] * bv[j], bdv = weight * bu[i] * dv[j];
      jet.point = jet.point + b * points_[k];
      jet.by_u = jet.by_u + bdu * points_[k];
      jet.by_v = jet.by_v + bdv * points_[k];
      w += b;
      wu += bdu;
      wv += bdv;
    }
  }
  if (weights_.empty()) return jet;
  jet.point = (1.0 / w) * jet.point;
  jet.by_u = (1.0 / w) * (jet.by_u - wu * jet.point);
  jet.by_v = (1.0 / w) * (jet.by_v - wv * jet.point);
  return jet;
}

}  // namespace bench
