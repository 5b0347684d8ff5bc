// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/rays.h"
#include "lucerna/source/adaptive/mixture/layer_split.h"
#include "lucerna/source/adaptive/mixture/wavelengths.h"
#include "lucerna/source/adaptive/sampling/adaptive_model.h"
#include "lucerna/source/adaptive/search/support_search.h"
#include "lucerna/source/adaptive/tree/tree_marginals.h"

namespace lucerna {

/// How deep trees grow, and how many a chart has.
struct TreeSetting {
  int trees = 1;
  double penalty_nats = 6.0;
};

/// Which light a layer is made of: all of its band, its part of two that overlap, or what these miss.
enum class LayerPart { whole, first, second, rest };

/// A layer whose trees are grown and not yet pruned.
struct GrownLayer {
  AdaptiveLayer layer;  ///< charts without nodes
  BoundedSupport on;
  LayerPart part = LayerPart::whole;
  /// By chart.
  std::vector<std::vector<GrownTree>> trees;
  std::vector<TreeMarginals> marginals;
};

/// What light is parted by.
struct LightParts {
  const SearchResult& search;
  const std::optional<LayerSplit>& split;
  const ColourBands& bands;
  double tolerance_mm = 0.0;
  std::uint64_t seed = 1;

  /// The part of each ray that the second of two layers has; empty where there is one. `as_a_whole`: each ray
  /// goes to one of them, by chance.
  std::vector<float> second(const RayBlock& rays, bool as_a_whole) const;
  /// The support that comes first in every band.
  const BoundedSupport& first() const { return split ? split->first() : search.best.on; }
  /// The weights of the rays of one of several bands, 0 for rays of others; empty where there is one.
  std::vector<float> of_band(const RayBlock& rays, std::span<const float> nm, std::uint32_t band) const;
  /// How many bands have layers of their own.
  std::uint32_t band_count() const;
};

/// Weights of which each is the part of a ray that the layer has, before any was missed.
std::vector<float> of_part(LayerPart part, std::span<const float> weight, std::span<const float> second);

/// Appends rays `which` with the part of their weight that a layer had.
void append_chosen(RayBlock& out, const RayBlock& rays, std::span<const float> weight,
                   const std::vector<std::uint32_t>& which);

/// All layers of all bands, one after the other, so that only one holds its rays: of each band the best
/// support, a second one that overlaps it if there is one, and what they miss. Shares sum to 1.
std::vector<GrownLayer> grown_layers(const RayBlock& rays, std::span<const float> nm, const LightParts& parts,
                                     const TreeSetting& setting, Progress& progress);

}  // namespace lucerna
