// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/compression/grown_layers.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"
#include "lucerna/source/adaptive/compression/exact_trees.h"
#include "lucerna/source/adaptive/tree/leaf_calibration.h"

namespace lucerna {

namespace {

/// Charts with less of the flux than this are dropped, and their flux given to the others.
constexpr double kSmallestShare = 1e-7;
/// Trees are grown a little further than they are kept, so that splits which pay later are found.
constexpr double kGrowShare = 0.7;
/// Above so many rays each goes to one of two layers as a whole, by chance: half the work, and noise that so
/// many rays do not show.
constexpr std::size_t kWholeRays = 4'500'000;
/// Standard deviations by which rays must contradict calibrated trees.
constexpr double kContradiction = 5.0;

/// Where rays contradict what the calibrated trees sum to, no leaves follow the pattern that they show: the
/// last tree but one is then grown anew with place cut first, or the last with direction.
void add_marginal_trees(ChartItems& c, const TreeMarginals& rays, const GrowOptions& grow, double penalty,
                        std::vector<GrownTree>& trees) {
  constexpr std::size_t kMinTrees = 16;
  if (trees.size() < kMinTrees) return;
  const ExactTrees exact = exact_trees(trees, c.box, penalty, trees.size(), &rays);
  const auto found = contradictions(exact.trees, c.box, rays, exact.leaf_shares);
  constexpr std::array<std::uint32_t, 2> kFirst{kPlaceAxes, kDirectionAxes};
  for (std::size_t k = 0; k < 2; ++k) {
    if (found[k] < kContradiction) continue;
    const std::size_t t = trees.size() - 2 + k;
    GrowOptions first = grow;
    first.tree_number = t, first.first_axes = kFirst[k];
    trees[t] = std::move(grow_trees(c.items, c.box, first, 1).front());
  }
}

GrownLayer grown_layer(Projection& p, const BoundedSupport& on, double total_weight, int trees,
                       double penalty, Progress& progress) {
  GrownLayer grown;
  grown.on = on;
  grown.layer.support = on.support;
  grown.layer.share = p.weight / total_weight;
  for (ChartItems& c : p.charts) {
    if (c.weight < kSmallestShare * total_weight) continue;
    progress.step("compress: trees", static_cast<std::uint64_t>(&c - p.charts.data()), p.charts.size());
    grown.layer.charts.push_back({c.chart, c.weight, c.box, {}});
    grown.marginals.emplace_back(c.items, c.box);
    const GrowOptions grow{.penalty_nats = penalty, .fine_trees = trees > 2 ? 0u : kFineOfTwo};
    grown.trees.push_back(grow_trees(c.items, c.box, grow, static_cast<std::size_t>(trees)));
    add_marginal_trees(c, grown.marginals.back(), grow, penalty / kGrowShare, grown.trees.back());
    c.items = {};
  }
  double sum = 0.0;
  for (const AdaptiveChart& c : grown.layer.charts) sum += c.share;
  for (AdaptiveChart& c : grown.layer.charts) c.share /= sum;
  return grown;
}

std::string describe_choice(const SearchResult& search) {
  if (search.degenerate) return "the rays fill no étendue";
  std::string text =
      fmt::format("{:.2f} % of the flux, {:.3f} nats per ray", 100.0 * search.best.carried, search.best.nats);
  const RefractingSphere& dome = search.best.on.support.dome;
  if (dome.exists()) {
    text += fmt::format("; in a dome of R {:.3f} mm, index {:.3f}", dome.radius_mm, dome.index);
  }
  std::array<std::array<bool, kSupportKinds>, 2> reported{};
  reported[dome.exists() ? 1 : 0][static_cast<std::size_t>(search.best.on.support.kind)] = true;
  for (const SupportScore& runner_up : search.runners_up) {
    const Support& s = runner_up.on.support;
    bool& known = reported[s.dome.exists() ? 1 : 0][static_cast<std::size_t>(s.kind)];
    if (known) continue;
    known = true;
    text += fmt::format("; {:.3f} better than {}{}", search.coarse_nats - runner_up.nats, to_string(s.kind),
                        s.dome.exists() ? " in a dome" : "");
  }
  return text;
}

/// Gives boxes that few rays left without an edge a small one: only light that has no étendue as a whole may
/// have charts without.
void widen(Projection& p, const Support& support, double tolerance_mm) {
  constexpr double kDirection = 1e-3;
  for (ChartItems& c : p.charts) {
    for (std::size_t d = 0; d < 4; ++d) {
      if (c.box.width(d) > 0.0) continue;
      const auto range = support.range(c.chart, d);
      const double middle = c.box.low[d], half = d < 2 ? 100.0 * tolerance_mm : kDirection;
      c.box.low[d] = std::max(middle - half, range[0]);
      c.box.high[d] = std::min(middle + half, range[1]);
    }
  }
}

/// Everything that the best support leaves over: lines about the focus, without bounds.
BoundedSupport background_support(const BoundedSupport& best, const RayBlock& rays) {
  Support s;
  s.kind = SupportKind::focal;
  s.map = PolarMap::concentric;
  s.world_from_support = best.support.world_from_support;
  BoundedSupport all = bounded(s, rays);
  for (std::size_t d = 0; d < 2; ++d) all.limits[0].low[d] = -1e9, all.limits[0].high[d] = 1e9;
  return all;
}

double sum_of(std::span<const float> weight) {
  double sum = 0.0;
  for (const float w : weight) sum += static_cast<double>(w);
  return sum;
}

/// Grows the layers of a model one after the other, so that only one holds its rays.
struct LayerGrower {
  const RayBlock& rays;
  const LightParts& parts;
  TreeSetting setting;
  double total_weight;
  Progress& progress;
  std::vector<GrownLayer> grown = {};
  RayBlock missed = {};
  /// Of the layers that are added, and in words.
  std::uint32_t band = 0;
  std::string light = "";

  /// Adds a layer of `weight`; rays that it cannot carry go to `missed`.
  void add(LayerPart part, const BoundedSupport& on, std::span<const float> weight, bool has_etendue,
           const std::string& why) {
    Projection p = project(rays, weight, on, parts.tolerance_mm);
    append_chosen(missed, rays, weight, p.missed);
    p.missed = {};
    add(part, p, on, has_etendue, why);
  }

  void add_background(const BoundedSupport& best) {
    if (missed.empty()) return;
    const BoundedSupport rest = background_support(best, missed);
    Projection p = project(missed, missed.weight, rest, parts.tolerance_mm);
    add(LayerPart::rest, p, rest, true, "what the layers above do not carry");
    missed = {};
  }

  void add(LayerPart part, Projection& p, const BoundedSupport& on, bool has_etendue,
           const std::string& why) {
    if (has_etendue) widen(p, on.support, parts.tolerance_mm);
    GrownLayer g =
        grown_layer(p, on, total_weight, setting.trees, kGrowShare * setting.penalty_nats, progress);
    if (g.layer.charts.empty()) return;
    g.part = part;
    g.layer.why = light + why;
    g.layer.band = band;
    grown.push_back(std::move(g));
  }
};

/// The layers of one band of wavelengths.
void add_layers(LayerGrower& grower, std::span<const float> weight, std::span<const float> second) {
  const SearchResult& search = grower.parts.search;
  const BoundedSupport& first = grower.parts.first();
  // What the search says of a support is not true of one that took its place.
  const std::string choice = first.support == search.best.on.support
                                 ? describe_choice(search)
                                 : "searched for again without the light that overlaps";
  const std::string why = fmt::format("{}; {} trees, {:.1f} nats a split", choice, grower.setting.trees,
                                      grower.setting.penalty_nats);
  if (const auto& split = grower.parts.split) {
    grower.add(LayerPart::first, first, of_part(LayerPart::first, weight, second), true, why);
    grower.add(LayerPart::second, split->second(), of_part(LayerPart::second, weight, second), true,
               fmt::format("light that overlaps: {:.4f} +- {:.4f} nats per ray better than without",
                           split->gain_nats(), split->gain_error()));
  } else {
    grower.add(LayerPart::whole, first, weight, !search.degenerate, why);
  }
  grower.add_background(first);
}

}  // namespace

std::vector<float> LightParts::second(const RayBlock& rays, bool as_a_whole) const {
  if (!split) return {};
  std::vector<float> part = split->second_responsibilities(rays);
  if (!as_a_whole) return part;
  constexpr std::size_t kBlock = 1 << 14;
  parallel_blocks(part.size(), kBlock, [&](std::size_t a, std::size_t b) {
    for (std::size_t i = a; i < b; ++i) {
      if (part[i] > 0.0f && part[i] < 1.0f)
        part[i] = Rng(seed, i).uniform() < static_cast<double>(part[i]) ? 1.0f : 0.0f;
    }
  });
  return part;
}

std::vector<float> LightParts::of_band(const RayBlock& rays, std::span<const float> nm,
                                       std::uint32_t band) const {
  if (bands.cuts_nm.empty()) return {};
  std::vector<float> weight(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) weight[i] = bands.band(nm[i]) == band ? rays.weight[i] : 0.0f;
  return weight;
}

std::uint32_t LightParts::band_count() const {
  return bands.cuts_nm.empty() ? 1 : static_cast<std::uint32_t>(bands.tables.size());
}

std::vector<float> of_part(LayerPart part, std::span<const float> weight, std::span<const float> second) {
  std::vector<float> out(weight.begin(), weight.end());
  for (std::size_t i = 0; i < out.size() && !second.empty(); ++i)
    out[i] *= part == LayerPart::second ? second[i] : 1.0f - second[i];
  return out;
}

void append_chosen(RayBlock& out, const RayBlock& rays, std::span<const float> weight,
                   const std::vector<std::uint32_t>& which) {
  for (const std::uint32_t i : which) {
    out.append(rays, i);
    out.weight.back() = weight[i];
  }
}

std::vector<GrownLayer> grown_layers(const RayBlock& rays, std::span<const float> nm, const LightParts& parts,
                                     const TreeSetting& setting, Progress& progress) {
  LayerGrower grower{rays, parts, setting, sum_of(rays.weight), progress};
  const std::vector<float> second = parts.second(rays, rays.size() > kWholeRays);
  for (std::uint32_t b = 0; b < parts.band_count(); ++b) {
    const std::vector<float> of_band = parts.of_band(rays, nm, b);
    const std::span<const float> weight = of_band.empty() ? rays.weight : of_band;
    if (!parts.bands.cuts_nm.empty()) {
      const WavelengthTable& table = parts.bands.tables[b];
      grower.band = b;
      grower.light = fmt::format("{:.0f} to {:.0f} nm; ", table.nm.front(), table.nm.back());
    }
    if (sum_of(weight) > 0.0) add_layers(grower, weight, second);
  }
  double sum = 0.0;
  for (const GrownLayer& g : grower.grown) sum += g.layer.share;
  for (GrownLayer& g : grower.grown) g.layer.share /= sum;
  return std::move(grower.grown);
}

}  // namespace lucerna
