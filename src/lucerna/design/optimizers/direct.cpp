// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <map>

#include "lucerna/design/optimizers/global_search.h"

namespace lucerna::detail {

namespace {

/// A box of the division: sides are 2 / 3^level.
struct Cell {
  Eigen::VectorXd centre;
  std::vector<int> level;
  double cost;

  /// The longest side, as its level: the size of the locally biased variant.
  int size() const { return *std::min_element(level.begin(), level.end()); }
};

double width(int size) { return 2.0 * std::pow(3.0, -size); }

/// The cells that some rate of change could hide the least cost in: the lower right hull of (size, cost), one
/// a size, where the promise is at least a little less than the best.
std::vector<std::size_t> promising(const std::vector<Cell>& cells, double best) {
  std::map<int, std::size_t> min;  // by size, the largest boxes first
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const auto [at, fresh] = min.try_emplace(cells[i].size(), i);
    if (!fresh && cells[i].cost < cells[at->second].cost) at->second = i;
  }
  std::vector<std::size_t> hull;
  for (const auto& [size, i] : min) {
    // From the largest down: keep those below the line from what is kept to what comes.
    while (!hull.empty() && !std::isfinite(cells[hull.back()].cost)) hull.pop_back();
    if (!hull.empty() && cells[i].cost >= cells[hull.back()].cost) continue;
    while (hull.size() >= 2) {
      const Cell &a = cells[hull[hull.size() - 2]], &b = cells[hull.back()], &c = cells[i];
      const double wa = width(a.size()), wb = width(b.size()), wc = width(size);
      const double line = c.cost + (a.cost - c.cost) * (wb - wc) / (wa - wc);
      if (b.cost <= line) break;
      hull.pop_back();
    }
    hull.push_back(i);
  }
  // Jones' epsilon: a tiny box is not worth dividing for a gain below 1e-4 of the best.
  while (hull.size() >= 2) {
    const Cell &a = cells[hull[hull.size() - 2]], &b = cells[hull.back()];
    const double rate = (a.cost - b.cost) / (width(a.size()) - width(b.size()));
    if (b.cost - rate * width(b.size()) <= best - 1e-4 * std::abs(best)) break;
    hull.pop_back();
  }
  return hull;
}

}  // namespace

void direct(GlobalSearchRun& run) {
  const auto n = static_cast<std::size_t>(run.size());
  std::vector<Cell> cells{{Eigen::VectorXd::Zero(run.size()), std::vector<int>(n, 0), run.best().cost}};
  while (!run.spent()) {
    struct Trial {
      std::size_t cell, axis;
    };
    std::vector<Trial> trials;
    std::vector<Eigen::VectorXd> points;
    for (const std::size_t i : promising(cells, run.best().cost)) {
      const Cell& c = cells[i];
      const int size = c.size();
      if (width(size) < 1e-9) continue;
      for (std::size_t d = 0; d < n; ++d) {
        if (c.level[d] != size) continue;
        trials.push_back({i, d});
        for (const double sign : {1.0, -1.0}) {
          points.push_back(c.centre);
          points.back()[static_cast<Eigen::Index>(d)] += sign * width(size) / 3.0;
        }
      }
    }
    if (points.empty()) return;
    const std::vector<double> costs = run.costs(points);
    // Along the better axes first, so that the better points keep the larger boxes.
    for (std::size_t first = 0; first < trials.size();) {
      std::size_t last = first;
      while (last < trials.size() && trials[last].cell == trials[first].cell) ++last;
      std::vector<std::size_t> order;
      for (std::size_t t = first; t < last; ++t) order.push_back(t);
      const auto better = [&](std::size_t t) { return std::min(costs[2 * t], costs[2 * t + 1]); };
      std::stable_sort(order.begin(), order.end(),
                       [&](std::size_t a, std::size_t b) { return better(a) < better(b); });
      for (const std::size_t t : order) {
        ++cells[trials[t].cell].level[trials[t].axis];
        for (const std::size_t side : {2 * t, 2 * t + 1}) {
          cells.push_back({points[side], cells[trials[t].cell].level, costs[side]});
        }
      }
      first = last;
    }
  }
}

}  // namespace lucerna::detail
