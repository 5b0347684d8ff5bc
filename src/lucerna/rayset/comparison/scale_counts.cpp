// SPDX-License-Identifier: Apache-2.0
#include "lucerna/rayset/comparison/scale_counts.h"

#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/rayset/comparison/cell_difference.h"
#include "lucerna/rayset/comparison/view_window.h"

namespace lucerna {

namespace {

constexpr std::size_t kScaleBlock = std::size_t{1} << 18;

/// Sums of 2 x 2 neighbours.
std::vector<double> half_as_fine(const std::vector<double>& cells, std::size_t side) {
  const std::size_t half = side / 2;
  std::vector<double> sums(half * half, 0.0);
  for (std::size_t i = 0; i < side; ++i) {
    for (std::size_t j = 0; j < side; ++j) sums[i / 2 * half + j / 2] += cells[i * side + j];
  }
  return sums;
}

}  // namespace

ScaleCounts::ScaleCounts(const Views& views)
    : views_(&views),
      window_(views.window(ViewKind::focus)),
      weights_(kSide * kSide, 0.0),
      squares_(kSide * kSide, 0.0) {
  window_.cells = {kSide, kSide, 1, 1};
}

void ScaleCounts::add(const RayBlock& rays) {
  struct Part {
    double total = 0.0;
    std::vector<double> weights, squares;
  };
  const auto parts =
      parallel_map_blocks<Part>(rays.size(), kScaleBlock, [&](std::size_t first, std::size_t last) {
        Part part{0.0, std::vector<double>(weights_.size(), 0.0), std::vector<double>(weights_.size(), 0.0)};
        for (std::size_t i = first; i < last; ++i) {
          const double w = static_cast<double>(rays.weight[i]);
          if (!(w > 0.0)) continue;
          part.total += w;
          const auto at = views_->coordinates(ViewKind::focus, rays.ray(i));
          if (!at) continue;
          const std::size_t cell = cell_of(window_, *at);
          if (cell >= part.weights.size()) continue;
          part.weights[cell] += w;
          part.squares[cell] += w * w;
        }
        return part;
      });
  for (const Part& part : parts) {
    total_weight_ += part.total;
    for (std::size_t i = 0; i < weights_.size(); ++i) {
      weights_[i] += part.weights[i];
      squares_[i] += part.squares[i];
    }
  }
}

std::array<ScaleDifference, 5> compare_scales(const ScaleCounts& reference, const ScaleCounts& test,
                                              const ScaleCounts& training) {
  if (!(reference.total_weight() > 0.0)) throw InputError("the reference has no rays with flux");
  if (!(test.total_weight() > 0.0)) throw InputError("the set to compare has no rays with flux");
  const ViewWindow& window = reference.window();
  double cell_mm = std::sqrt((window.high[0] - window.low[0]) * (window.high[1] - window.low[1])) /
                   static_cast<double>(ScaleCounts::kSide);
  std::array<CellWeights, 3> sets{{{reference.weights(), reference.squares(), reference.total_weight()},
                                   {test.weights(), test.squares(), test.total_weight()},
                                   {training.weights(), training.squares(), training.total_weight()}}};
  std::array<ScaleDifference, 5> scales;
  std::size_t side = ScaleCounts::kSide;
  for (ScaleDifference& scale : scales) {
    scale.cell_mm = cell_mm;
    scale.difference = cell_difference(sets[0], sets[1], sets[2]);
    for (CellWeights& set : sets) {
      set.weights = half_as_fine(set.weights, side);
      set.squares = half_as_fine(set.squares, side);
    }
    side /= 2;
    cell_mm *= 2.0;
  }
  return scales;
}

}  // namespace lucerna
