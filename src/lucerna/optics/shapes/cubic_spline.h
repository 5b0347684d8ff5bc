// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/core/io/error.h"

namespace lucerna {

/// What a cubic spline does at an end: its third derivative has no jump at the knot next to the end; slope 0;
/// second derivative 0.
enum class SplineEnd { not_a_knot, flat, natural };

namespace detail {

/// One equation of a tridiagonal system.
template <class T>
struct SplineRow {
  T lower = 0.0, diagonal = 1.0, upper = 0.0, right = 0.0;
};

/// The equation of an end: `inner` is the coefficient of the neighbouring knot's slope.
template <class T>
struct SplineEndRow {
  T diagonal = 1.0, inner = 0.0, right = 0.0;
};

/// `h0`, `d0` of the outermost interval, `h1`, `d1` of the next.
template <class T>
SplineEndRow<T> spline_end_row(SplineEnd kind, const T& h0, const T& d0, const T& h1, const T& d1) {
  if (kind == SplineEnd::flat) return {};
  if (kind == SplineEnd::natural) return {2.0, 1.0, 3.0 * d0};
  const T both = h0 + h1;
  return {h1, both, ((h0 + 2.0 * both) * h1 * d0 + h0 * h0 * d1) / both};
}

/// Solves it by elimination; the rows are overwritten.
template <class T>
std::vector<T> solved(std::vector<SplineRow<T>>& rows) {
  const std::size_t m = rows.size() - 1;
  for (std::size_t i = 1; i <= m; ++i) {
    const T w = rows[i].lower / rows[i - 1].diagonal;
    rows[i].diagonal -= w * rows[i - 1].upper;
    rows[i].right -= w * rows[i - 1].right;
  }
  std::vector<T> slope(m + 1);
  slope[m] = rows[m].right / rows[m].diagonal;
  for (std::size_t i = m; i-- > 0;)
    slope[i] = (rows[i].right - rows[i].upper * slope[i + 1]) / rows[i].diagonal;
  return slope;
}

}  // namespace detail

/// Slopes at the knots of the C2 cubic spline (C. de Boor, "A Practical Guide to Splines", ch. IV). `h`:
/// lengths of the intervals, > 0; `delta`: their secant slopes; at least two intervals. Of numbers, or of
/// numbers with their derivatives (core/math/dual.h). O(intervals).
template <class T>
std::vector<T> spline_slopes(const std::vector<T>& h, const std::vector<T>& delta, SplineEnd start,
                             SplineEnd end) {
  const std::size_t m = h.size();
  LUCERNA_CHECK(m >= 2 && delta.size() == m, "{} intervals, {} secants", m, delta.size());
  std::vector<detail::SplineRow<T>> rows(m + 1);
  detail::SplineEndRow<T> first = detail::spline_end_row(start, h[0], delta[0], h[1], delta[1]);
  detail::SplineEndRow<T> last = detail::spline_end_row(end, h[m - 1], delta[m - 1], h[m - 2], delta[m - 2]);
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
  return detail::solved(rows);
}

}  // namespace lucerna
