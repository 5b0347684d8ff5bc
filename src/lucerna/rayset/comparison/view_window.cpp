// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/view_window.h"

#include <algorithm>
#include <cmath>

#include "lucerna/random.h"

namespace lucerna {

namespace {

/// Share of the flux cut off at each end of an axis to find the window's proportions, before it is scaled to
/// 99 %.
constexpr double kTailShare = 0.0025;

std::vector<WeightedValue> axis_values(const WindowPoints& points, const std::vector<double>& weights,
                                       std::size_t axis) {
  std::vector<WeightedValue> values(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) values[i] = {points[i][axis], weights[i]};
  return values;
}

}  // namespace

double weighted_quantile(std::vector<WeightedValue>& items, double share) {
  std::sort(items.begin(), items.end(),
            [](const WeightedValue& a, const WeightedValue& b) { return a.value < b.value; });
  double total = 0.0, sum = 0.0;
  for (const WeightedValue& item : items) total += item.weight;
  for (const WeightedValue& item : items) {
    sum += item.weight;
    if (sum >= share * total) return item.value;
  }
  return items.empty() ? 0.0 : items.back().value;
}

void fit_view_window(const WindowPoints& points, const std::vector<double>& weights,
                     const std::array<double, 4>& min, ViewWindow& window) {
  std::array<double, 4> middle{}, half{};
  for (std::size_t k = 0; k < window.dimensions; ++k) {
    auto values = axis_values(points, weights, k);
    middle[k] = weighted_quantile(values, 0.5);
    half[k] = std::max(weighted_quantile(values, 1.0 - kTailShare) - middle[k],
                       middle[k] - weighted_quantile(values, kTailShare));
    half[k] = std::max(half[k], min[k]);
  }
  std::vector<WeightedValue> scales(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    double scale = 0.0;
    for (std::size_t k = 0; k < window.dimensions; ++k) {
      scale = std::max(scale, std::abs(points[i][k] - middle[k]) / half[k]);
    }
    scales[i] = {scale, weights[i]};
  }
  // A hair wider, so that the ray that fixes the edge lies inside in spite of rounding.
  const double scale = weighted_quantile(scales, kViewWindowShare) * (1.0 + 1e-9);
  for (std::size_t k = 0; k < window.dimensions; ++k) {
    const double width = std::max(scale * half[k], min[k]);
    window.low[k] = middle[k] - width;
    window.high[k] = middle[k] + width;
    if (width > min[k]) continue;
    // Nothing to resolve: half a cell aside, so that the one value lies inside a cell and not on a border.
    const double shift = width / static_cast<double>(window.cells[k]);
    window.low[k] -= shift;
    window.high[k] -= shift;
  }
}

std::size_t cell_of(const ViewWindow& w, const std::array<double, 4>& at) {
  std::size_t index = 0, cells = 1;
  bool inside = true;
  for (std::size_t k = 0; k < w.dimensions; ++k) {
    const double place = (at[k] - w.low[k]) / (w.high[k] - w.low[k]);
    if (place >= 0.0 && place <= 1.0) {
      const auto n = static_cast<double>(w.cells[k]);
      index = index * w.cells[k] + std::min(w.cells[k] - 1, static_cast<std::size_t>(place * n));
    } else {
      inside = false;  // NaN comes here too
    }
    cells *= w.cells[k];
  }
  return inside ? index : cells;
}

std::vector<std::size_t> stratified_choice(std::size_t rays, std::size_t max) {
  const std::size_t m = std::min(rays, max);
  std::vector<std::size_t> chosen(m);
  for (std::size_t i = 0; i < m; ++i) {
    const double u = m == rays ? 0.0 : Rng(0, i).uniform();
    chosen[i] =
        std::min(rays - 1, static_cast<std::size_t>((static_cast<double>(i) + u) * static_cast<double>(rays) /
                                                    static_cast<double>(m)));
  }
  return chosen;
}

}  // namespace lucerna
