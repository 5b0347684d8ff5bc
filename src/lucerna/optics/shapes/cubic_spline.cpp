// SPDX-License-Identifier: Apache-2.0
#include "lucerna/optics/shapes/cubic_spline.h"

#include "lucerna/core/io/error.h"

namespace lucerna {

namespace {

/// One equation of a tridiagonal system.
struct Row {
  double lower = 0.0, diagonal = 1.0, upper = 0.0, right = 0.0;
};

/// The equation of an end: `h0`, `d0` of the outermost interval, `h1`, `d1` of the next; `inner` is the
/// coefficient of the neighbouring knot's slope.
struct End {
  double diagonal = 1.0, inner = 0.0, right = 0.0;
};
End end_row(SplineEnd kind, double h0, double d0, double h1, double d1) {
  if (kind == SplineEnd::flat) return {};
  if (kind == SplineEnd::natural) return {2.0, 1.0, 3.0 * d0};
  const double both = h0 + h1;
  return {h1, both, ((h0 + 2.0 * both) * h1 * d0 + h0 * h0 * d1) / both};
}

}  // namespace

std::vector<double> spline_slopes(const std::vector<double>& h, const std::vector<double>& delta,
                                  SplineEnd start, SplineEnd end) {
  const std::size_t m = h.size();
  LUCERNA_CHECK(m >= 2 && delta.size() == m, "{} intervals, {} secants", m, delta.size());
  std::vector<Row> rows(m + 1);
  End first = end_row(start, h[0], delta[0], h[1], delta[1]);
  End last = end_row(end, h[m - 1], delta[m - 1], h[m - 2], delta[m - 2]);
  if (m == 2 && start == SplineEnd::not_a_knot && end == SplineEnd::not_a_knot) {
    // One parabola through three points: the two conditions are the same.
    first = {1.0, 1.0, 2.0 * delta[0]};
    last = {1.0, 1.0, 2.0 * delta[1]};
  }
  rows[0] = {0.0, first.diagonal, first.inner, first.right};
  rows[m] = {last.inner, last.diagonal, 0.0, last.right};
  for (std::size_t i = 1; i < m; ++i) {
    rows[i] = {h[i], 2.0 * (h[i - 1] + h[i]), h[i - 1], 3.0 * (h[i] * delta[i - 1] + h[i - 1] * delta[i])};
  }
  for (std::size_t i = 1; i <= m; ++i) {
    const double w = rows[i].lower / rows[i - 1].diagonal;
    rows[i].diagonal -= w * rows[i - 1].upper;
    rows[i].right -= w * rows[i - 1].right;
  }
  std::vector<double> slope(m + 1);
  slope[m] = rows[m].right / rows[m].diagonal;
  for (std::size_t i = m; i-- > 0;)
    slope[i] = (rows[i].right - rows[i].upper * slope[i + 1]) / rows[i].diagonal;
  return slope;
}

}  // namespace lucerna
