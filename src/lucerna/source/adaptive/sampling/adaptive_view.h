// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "lucerna/source/adaptive/charts/support_ray.h"

namespace lucerna {

/// A leaf as the sampler reads it: 40 bytes, the same on a GPU. A ray of the leaf is `low + t * width` in the
/// four numbers of its place, t in [0, 1)^4.
struct SamplerLeaf {
  std::array<float, 4> low{}, width{};
  /// First of the 2^32 values of a random number that choose this leaf.
  std::uint32_t first = 0;
  /// Index into the model's places (layer and chart).
  std::uint32_t place = 0;
};

/// A chart of a layer's support.
struct SamplerPlace {
  Support support;
  std::uint32_t chart = 0;
};

/// The flat arrays that AdaptiveModel draws rays from, on the CPU or copied to a GPU. Points into them.
struct AdaptiveView {
  /// One more than there are: the last only ends the one before.
  const SamplerLeaf* leaves = nullptr;
  const std::uint32_t* guide = nullptr;
  const SamplerPlace* places = nullptr;
  std::uint32_t leaf_count = 0, guide_count = 0, place_count = 0, guide_shift = 31;
  /// Where rays start.
  BoundingSurface surface;
};

/// The leaf that the 32 random bits choose.
LUCERNA_HD inline std::size_t adaptive_leaf(const SamplerLeaf* leaves, std::size_t leaf_count,
                                            const std::uint32_t* guide, unsigned guide_shift,
                                            std::uint32_t bits) {
  std::size_t i = guide[bits >> guide_shift];
  while (i + 2 < leaf_count && leaves[i + 1].first <= bits) ++i;
  return i;
}

/// The part of the leaf's stretch of first numbers that lies below `bits`.
LUCERNA_HD inline double adaptive_place_in(const SamplerLeaf* leaves, std::size_t leaf, std::uint32_t bits) {
  // One less than the length, so that the rest of 2^32 at the last leaf wraps as it should.
  const std::uint32_t first = leaves[leaf].first, length = leaves[leaf + 1].first - first - 1;
  return (static_cast<double>(bits - first) + 0.5) * (1.0 / (static_cast<double>(length) + 1.0));
}

/// AdaptiveModel::sample for supports that ray_from_chart knows, on any device.
LUCERNA_HD inline Ray sample_adaptive(const AdaptiveView& v, const std::array<double, 4>& u) {
  const auto bits = static_cast<std::uint32_t>(u[0] * 4294967296.0);
  const std::size_t i = adaptive_leaf(v.leaves, v.leaf_count, v.guide, v.guide_shift, bits);
  const SamplerLeaf& leaf = v.leaves[i];
  const SamplerPlace& place = v.places[leaf.place];
  ChartPoint p{place.chart, {}};
  for (std::size_t d = 0; d < 4; ++d) {
    const double t = d == 0 ? adaptive_place_in(v.leaves, i, bits) : u[d];
    p.c[d] = static_cast<double>(leaf.low[d]) + t * static_cast<double>(leaf.width[d]);
  }
  const Ray ray = ray_from_chart(place.support, p);
  const auto placed = placed_on(v.surface, ray);
  return placed ? *placed : ray;
}

}  // namespace lucerna
