// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/mixture/penalty_choice.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/source/adaptive/search/support_search.h"

namespace lucerna {

namespace {

constexpr std::size_t kPenaltyRays = 250'000, kPenaltyBlock = 4096;
/// Nothing is impossible: the least density of a held-out ray, as a share of even light.
constexpr double kFloor = 1e-4;

/// Sum over held-out rays of log(mean density of the trees), weighted.
double log_likelihood(const std::vector<TreeLookup>& trees, const std::vector<TreeItem>& held,
                      double volume) {
  const auto sums =
      parallel_map_blocks<double>(held.size(), kPenaltyBlock, [&](std::size_t first, std::size_t last) {
        std::vector<std::array<double, 4>> points(last - first);
        std::vector<double> density(last - first, 0.0);
        for (std::size_t i = first; i < last; ++i) {
          const auto& c = held[i].c;
          std::copy(c.begin(), c.end(), points[i - first].begin());
        }
        for (const TreeLookup& tree : trees) tree.add_densities(points, density);
        double sum = 0.0;
        for (std::size_t i = first; i < last; ++i) {
          const double mean = density[i - first] / static_cast<double>(trees.size());
          sum += static_cast<double>(held[i].weight) * std::log((1.0 - kFloor) * mean + kFloor / volume);
        }
        return sum;
      });
  double sum = 0.0;
  for (const double s : sums) sum += s;
  return sum;
}

}  // namespace

double choose_penalty(const RayBlock& rays, const BoundedSupport& on, double tolerance_mm, int trees,
                      std::uint64_t seed) {
  const RayBlock some = stratified_choice(rays, kPenaltyRays, seed);
  RayBlock train, held;
  for (std::size_t i = 0; i < some.size(); ++i) (i % 5 == 4 ? held : train).append(some, i);
  Projection p = project(train, train.weight, on, tolerance_mm);
  Projection q = project(held, held.weight, on, tolerance_mm);
  std::array<double, kPenalties.size()> score{};
  for (ChartItems& chart : p.charts) {
    const auto held_out = std::find_if(q.charts.begin(), q.charts.end(),
                                       [&](const ChartItems& c) { return c.chart == chart.chart; });
    if (held_out == q.charts.end()) continue;
    const GrowOptions grow{.penalty_nats = kPenalties.front(), .fine_trees = trees > 1 ? 0u : 1u};
    const auto grown = grow_trees(chart.items, chart.box, grow, static_cast<std::size_t>(trees));
    for (std::size_t k = 0; k < kPenalties.size(); ++k) {
      std::vector<TreeLookup> lookups;
      for (const GrownTree& g : grown) lookups.emplace_back(prune_tree(g, kPenalties[k]), chart.box);
      score[k] += log_likelihood(lookups, held_out->items, chart.box.volume());
    }
  }
  const auto best = std::max_element(score.begin(), score.end());
  return kPenalties[static_cast<std::size_t>(best - score.begin())];
}

}  // namespace lucerna
