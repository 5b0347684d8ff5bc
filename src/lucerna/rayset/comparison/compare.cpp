// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_comparison.h"
#include "lucerna/rayset/comparison/cell_difference.h"

namespace lucerna {

namespace {

/// Rays counted apart before they are summed: one block's counts (about 0.3 MB) are small beside its time.
constexpr std::size_t kCompareBlock = std::size_t{1} << 18;

struct Part {
  double total = 0.0;
  std::array<std::vector<double>, 5> weights, squares;
};

Part count(const Views& views, const RayBlock& rays, std::size_t first, std::size_t last) {
  Part part;
  for (const ViewKind kind : kViewKinds) {
    part.weights[static_cast<std::size_t>(kind)].assign(views.cell_count(kind), 0.0);
    part.squares[static_cast<std::size_t>(kind)].assign(views.cell_count(kind), 0.0);
  }
  for (std::size_t i = first; i < last; ++i) {
    const double w = static_cast<double>(rays.weight[i]);
    if (!(w > 0.0)) continue;
    part.total += w;
    const Ray ray = rays.ray(i);
    for (const ViewKind kind : kViewKinds) {
      const auto cell = views.cell(kind, ray);
      if (!cell) continue;
      part.weights[static_cast<std::size_t>(kind)][*cell] += w;
      part.squares[static_cast<std::size_t>(kind)][*cell] += w * w;
    }
  }
  return part;
}

CellWeights cells_of(ViewKind kind, const ViewCounts& counts) {
  return {counts.weights(kind), counts.squares(kind), counts.total_weight()};
}

}  // namespace

ViewDifference cell_difference(const CellWeights& reference, const CellWeights& test,
                               const CellWeights& training) {
  const double total_p = reference.total_weight, total_q = test.total_weight, total_t = training.total_weight;
  double norm = 0.0, error = 0.0, noise = 0.0, noise_squared = 0.0, cross = 0.0, raw = 0.0;
  for (std::size_t i = 0; i < reference.weights.size(); ++i) {
    const double p = reference.weights[i] / total_p, q = test.weights[i] / total_q;
    const double variance =
        reference.squares[i] / (total_p * total_p) + test.squares[i] / (total_q * total_q);
    const double squared = (p - q) * (p - q);
    norm += p * p;
    error += squared;
    noise += variance;
    noise_squared += variance * variance;
    cross += std::max(0.0, squared - variance) * variance;
    raw += training.squares[i] / (total_t * total_t);
  }
  ViewDifference result;
  if (norm <= 0.0) return result;  // the view sees nothing of the reference
  result.error = std::sqrt(error / norm);
  result.floor = std::sqrt(noise / norm);
  result.excess = std::sqrt(std::max(0.0, error - noise) / norm);
  result.raw = std::sqrt(raw / norm);
  // Standard deviation of error^2 for independent cells with normal noise.
  const bool seen = result.excess > 0.0;
  const double spread = std::sqrt(2.0 * noise_squared + (seen ? 4.0 * cross : 0.0)) / norm;
  result.standard_error = std::sqrt(spread);
  if (seen) result.standard_error = std::min(result.standard_error, spread / (2.0 * result.excess));
  return result;
}

ViewCounts::ViewCounts(const Views& views) : views_(&views) {
  for (const ViewKind kind : kViewKinds) {
    weights_[static_cast<std::size_t>(kind)].assign(views.cell_count(kind), 0.0);
    squares_[static_cast<std::size_t>(kind)].assign(views.cell_count(kind), 0.0);
  }
}

void ViewCounts::add(const RayBlock& rays) {
  const auto parts = parallel_map_blocks<Part>(
      rays.size(), kCompareBlock,
      [&](std::size_t first, std::size_t last) { return count(*views_, rays, first, last); });
  for (const Part& part : parts) {
    total_weight_ += part.total;
    for (std::size_t k = 0; k < weights_.size(); ++k) {
      for (std::size_t i = 0; i < weights_[k].size(); ++i) {
        weights_[k][i] += part.weights[k][i];
        squares_[k][i] += part.squares[k][i];
      }
    }
  }
}

const ViewDifference& RaySetComparison::operator[](ViewKind kind) const {
  switch (kind) {
    case ViewKind::far:
      return far;
    case ViewKind::near:
      return near;
    case ViewKind::focus:
      return focus;
    case ViewKind::beam:
      return beam;
    case ViewKind::four_d:
      return four_d;
  }
  return far;
}

ViewDifference& RaySetComparison::operator[](ViewKind kind) {
  return const_cast<ViewDifference&>(std::as_const(*this)[kind]);
}

RaySetComparison compare_view_counts(const ViewCounts& reference, const ViewCounts& test,
                                     const ViewCounts* training) {
  LUCERNA_CHECK(&reference.views() == &test.views() && (!training || &training->views() == &test.views()),
                "counts of different views");
  if (!(reference.total_weight() > 0.0)) throw InputError("the reference has no rays with flux");
  if (!(test.total_weight() > 0.0)) throw InputError("the set to compare has no rays with flux");
  RaySetComparison result;
  for (const ViewKind kind : kViewKinds) {
    result[kind] = cell_difference(cells_of(kind, reference), cells_of(kind, test),
                                   cells_of(kind, training ? *training : reference));
  }
  return result;
}

RaySetComparison compare_ray_sets(const RayBlock& reference, const RayBlock& test, const RayBlock* training) {
  const Views views(reference);
  ViewCounts a(views), b(views);
  a.add(reference);
  b.add(test);
  if (!training) return compare_view_counts(a, b);
  ViewCounts c(views);
  c.add(*training);
  return compare_view_counts(a, b, &c);
}

}  // namespace lucerna
