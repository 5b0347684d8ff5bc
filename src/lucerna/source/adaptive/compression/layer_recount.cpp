// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/compression/layer_recount.h"

#include <algorithm>
#include <memory>
#include <span>

#include "lucerna/source/adaptive/tree/leaf_tally.h"

namespace lucerna {

namespace {

/// What rays add up to in one layer.
class LayerTally {
 public:
  explicit LayerTally(GrownLayer& layer) : layer_(layer), weight_(layer.trees.size(), 0.0) {
    for (std::size_t i = 0; i < layer.trees.size(); ++i) {
      const TreeBox& box = layer.layer.charts[i].box;
      for (const GrownTree& tree : layer.trees[i]) tallies_.push_back({i, LeafTally(tree, box)});
      layer.marginals[i].clear();
    }
  }

  const GrownLayer& layer() const { return layer_; }

  /// Counts the rays that the layer's support carries; returns the others. Charts that the layer has not are
  /// passed over, as when it was grown.
  std::vector<std::uint32_t> add(const RayBlock& rays, std::span<const float> weight, double tolerance_mm) {
    Projection p = project(rays, weight, layer_.on, tolerance_mm);
    const auto& charts = layer_.layer.charts;
    for (ChartItems& c : p.charts) {
      const auto at = std::ranges::find(charts, c.chart, &AdaptiveChart::chart);
      if (at == charts.end()) continue;
      const auto i = static_cast<std::size_t>(at - charts.begin());
      weight_[i] += c.weight;
      layer_.marginals[i].add(c.items);
      for (OneTree& t : tallies_) {
        if (t.chart == i) t.tally.add(c.items);
      }
    }
    return std::move(p.missed);
  }

  /// Hands the counts to the layer; its share is the weight of its charts.
  void apply() {
    double sum = 0.0;
    std::vector<std::size_t> tree(layer_.trees.size(), 0);
    for (const OneTree& t : tallies_) t.tally.apply(layer_.trees[t.chart][tree[t.chart]++]);
    for (const double w : weight_) sum += w;
    for (std::size_t i = 0; i < weight_.size() && sum > 0.0; ++i)
      layer_.layer.charts[i].share = weight_[i] / sum;
    layer_.layer.share = sum;
  }

 private:
  struct OneTree {
    std::size_t chart;
    LeafTally tally;
  };
  GrownLayer& layer_;
  std::vector<double> weight_;  // by chart
  std::vector<OneTree> tallies_;
};

/// Counts a block for the layers of one band. The last of them has what the others miss, if there is one; if
/// not, that little light was too faint to have a layer, and is the others'.
void add_band(std::span<LayerTally> layers, const LightParts& parts, const RayBlock& rays,
              std::span<const float> weight, std::span<const float> second) {
  RayBlock missed;
  missed.resize(0, rays.extra.size());
  for (LayerTally& tally : layers) {
    const LayerPart part = tally.layer().part;
    if (part == LayerPart::rest) {
      static_cast<void>(tally.add(missed, missed.weight, parts.tolerance_mm));
    } else {
      const std::vector<float> own = of_part(part, weight, second);
      append_chosen(missed, rays, own, tally.add(rays, own, parts.tolerance_mm));
    }
  }
}

}  // namespace

std::uint64_t recount(std::vector<GrownLayer>& layers, const LightParts& parts, const RayStream& all_rays) {
  std::vector<LayerTally> tallies(layers.begin(), layers.end());
  std::uint64_t count = 0;
  all_rays([&](const RayBlock& block) {
    const std::vector<float> second = parts.second(block, false);
    const std::span<const float> nm = block.extra.empty() ? std::span<const float>() : block.extra.front();
    for (auto first = tallies.begin(); first != tallies.end();) {
      const std::uint32_t band = first->layer().layer.band;
      const auto last = std::find_if(first, tallies.end(),
                                     [&](const LayerTally& t) { return t.layer().layer.band != band; });
      const std::vector<float> of_band = parts.of_band(block, nm, band);
      add_band({first, last}, parts, block, of_band.empty() ? block.weight : of_band, second);
      first = last;
    }
    count += block.size();
  });
  double sum = 0.0;
  for (LayerTally& tally : tallies) tally.apply();
  for (const GrownLayer& g : layers) sum += g.layer.share;
  for (GrownLayer& g : layers) g.layer.share /= sum;
  return count;
}

}  // namespace lucerna
