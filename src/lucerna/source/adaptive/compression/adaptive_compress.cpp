// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/compression/adaptive_compress.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/random.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/rayset/statistics/surface_guess.h"
#include "lucerna/source/adaptive/mixture/layer_split.h"
#include "lucerna/source/adaptive/mixture/penalty_choice.h"
#include "lucerna/source/adaptive/search/support_search.h"
#include "lucerna/source/adaptive/tree/leaf_calibration.h"
#include "lucerna/source/file/nfl.h"

namespace lucerna {

namespace {

/// Charts with less of the flux than this are dropped, and their flux given to the others.
constexpr double kSmallestShare = 1e-7;
/// Trees are grown a little further than they are kept, so that splits which pay later are found.
constexpr double kGrowShare = 0.7;

/// Views sum over much of the four dimensions, where noise averages out and blur does not: they want deeper
/// trees than the likelihood of single rays does (docs/theory/source-model.md, "Depth").
constexpr double kDeeper = 0.7;

/// Of two trees the first offers all cuts. The penalty is chosen for a quarter of them: four times as many
/// find as much by chance with ln 4 nats more.
constexpr std::size_t kFineOfTwo = 1;
constexpr double kFineNats = 1.3862943611198906;

/// A layer whose trees are grown and not yet pruned.
struct GrownLayer {
  AdaptiveLayer layer;  // charts without nodes
  std::vector<std::vector<GrownTree>> trees;
  std::vector<TreeMarginals> marginals;
};

struct Setting {
  int trees = 1;
  double penalty_nats = 6.0;
};

/// Standard deviations by which rays must contradict calibrated trees.
constexpr double kContradiction = 5.0;

/// More trees smooth what few rays leave rough; many rays need less smoothing and cost time.
int default_trees(std::size_t rays) {
  if (rays <= 250'000) return 16;
  if (rays <= 1'000'000) return 8;
  if (rays <= 4'500'000) return 4;
  return 2;
}

/// The trees of a chart without the rounding of its file: the first `trees` of `from` pruned by `penalty`,
/// and calibrated where `calibration` is given; on all threads.
struct ExactTrees {
  std::vector<DensityTree> trees;
  std::vector<std::vector<double>> leaf_shares;
};

ExactTrees exact_trees(const std::vector<GrownTree>& from, const TreeBox& box, double penalty, int trees,
                       const TreeMarginals* calibration) {
  const std::size_t n = std::min<std::size_t>(from.size(), static_cast<std::size_t>(trees));
  ExactTrees to{std::vector<DensityTree>(n), std::vector<std::vector<double>>(n)};
  parallel_blocks(n, 1, [&](std::size_t t, std::size_t) {
    const bool fine = from.size() == 2 && t < kFineOfTwo;
    PrunedTree pruned = prune_exactly(from[t], penalty + (fine ? kFineNats : 0.0));
    to.trees[t] = std::move(pruned.tree), to.leaf_shares[t] = std::move(pruned.leaf_shares);
  });
  if (calibration) calibrate_leaves(to.trees, box, *calibration, to.leaf_shares);
  return to;
}

std::vector<DensityTree> pruned_trees(const std::vector<GrownTree>& from, const TreeBox& box, double penalty,
                                      int trees, const TreeMarginals* calibration) {
  ExactTrees exact = exact_trees(from, box, penalty, trees, calibration);
  parallel_blocks(exact.trees.size(), 1, [&](std::size_t t, std::size_t) {
    exact.trees[t] = settled({std::move(exact.trees[t]), std::move(exact.leaf_shares[t])});
  });
  return std::move(exact.trees);
}

/// Where rays contradict what the calibrated trees sum to, no leaves follow the pattern that they show: the
/// last tree but one is then grown anew with place cut first, or the last with direction.
void add_marginal_trees(ChartItems& c, const TreeMarginals& rays, const GrowOptions& grow, double penalty,
                        std::vector<GrownTree>& trees) {
  constexpr std::size_t kMinTrees = 16;
  if (trees.size() < kMinTrees) return;
  const ExactTrees exact = exact_trees(trees, c.box, penalty, static_cast<int>(trees.size()), &rays);
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

GrownLayer grown_layer(Projection& p, const Support& support, double total_weight, int trees, double penalty,
                       Progress& progress) {
  GrownLayer grown;
  grown.layer.support = support;
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

/// The layers themselves; calibrated or, for a first look at their size, not.
std::vector<AdaptiveLayer> pruned(const std::vector<GrownLayer>& grown, double penalty, int trees,
                                  bool calibrated) {
  std::vector<AdaptiveLayer> layers;
  for (const GrownLayer& g : grown) layers.push_back(g.layer);
  struct Chart {
    std::size_t layer, chart;
  };
  std::vector<Chart> all;
  for (std::size_t k = 0; k < grown.size(); ++k) {
    for (std::size_t i = 0; i < grown[k].trees.size(); ++i) all.push_back({k, i});
  }
  parallel_blocks(all.size(), 1, [&](std::size_t i, std::size_t) {
    const GrownLayer& from = grown[all[i].layer];
    AdaptiveChart& to = layers[all[i].layer].charts[all[i].chart];
    to.trees = pruned_trees(from.trees[all[i].chart], to.box, penalty, trees,
                            calibrated ? &from.marginals[all[i].chart] : nullptr);
  });
  return layers;
}

/// The file's size. Large trees are counted before zstd, which does nothing for them but take time.
std::uint64_t file_bytes(const AdaptiveData& data) {
  constexpr std::uint64_t kFrame = 256, kLarge = 30'000;
  const NflFile file = encode_adaptive(data);
  std::uint64_t bytes = kFrame;
  for (const auto& section : file.sections) bytes += section.bytes.size();
  return bytes > kLarge ? bytes : encode_nfl(file).size();
}

/// False where so many leaves surely do not fit: they take 11 to 20 bits each.
bool fits(const AdaptiveData& data, std::uint64_t max_bytes) {
  constexpr std::uint64_t kMinBits = 6;
  return kMinBits * data.leaves() <= 8 * max_bytes && file_bytes(data) <= max_bytes;
}

/// The model of `penalty`, its leaves calibrated; false if it does not fit.
bool made(AdaptiveData& data, const std::vector<GrownLayer>& grown, double penalty, int trees,
          std::uint64_t max_bytes) {
  data.layers = pruned(grown, penalty, trees, true);
  return fits(data, max_bytes);
}

/// Prunes until the file fits: first by penalty, then with fewer trees.
void fit_to_size(AdaptiveData& data, const std::vector<GrownLayer>& grown, const Setting& setting,
                 std::uint64_t max_bytes) {
  const auto sized = [&](double penalty, int trees) {
    data.layers = pruned(grown, penalty, trees, false);
    return fits(data, max_bytes);
  };
  for (int trees = setting.trees;; trees /= 2) {
    double low = setting.penalty_nats, high = low;
    if (sized(low, trees) && made(data, grown, low, trees, max_bytes)) return;
    // So many rays that two trees were enough need no smoothing: leaves are better spent on one, which has
    // all cuts.
    if (trees > 1 && setting.trees == 2) continue;
    // Rougher trees than this are worse than fewer of them.
    const double max = trees > 1 ? 3.0 * setting.penalty_nats : 1e9;
    bool fit = false;
    do {
      low = high;
      high = std::min(max, 2.0 * high);
      fit = sized(high, trees);
    } while (!fit && high < max);
    if (!fit && trees > 1) continue;
    if (!fit) throw InputError(fmt::format("a model of these rays does not fit in {} bytes", max_bytes));
    for (int i = 0; i < 6; ++i) {
      const double middle = std::sqrt(low * high);
      (sized(middle, trees) ? high : low) = middle;
    }
    // Calibrated steps are a little longer.
    constexpr double kALittle = 1.02;
    while (!made(data, grown, high, trees, max_bytes)) high *= kALittle;
    return;
  }
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

/// Appends rays `which` with the part of their weight that a layer had.
void append_chosen(RayBlock& out, const RayBlock& rays, std::span<const float> weight,
                   const std::vector<std::uint32_t>& which) {
  for (const std::uint32_t i : which) {
    out.append(rays, i);
    out.weight.back() = weight[i];
  }
}

/// Grows the layers of a model one after the other, so that only one holds its rays.
struct LayerGrower {
  const RayBlock& rays;
  Setting setting;
  double total_weight, tolerance_mm;
  Progress& progress;
  std::vector<GrownLayer> grown = {};
  RayBlock missed = {};
  /// Of the layers that are added, and in words.
  std::uint32_t band = 0;
  std::string light = "";

  /// Adds a layer of `weight`; rays that it cannot carry go to `missed`.
  void add(const BoundedSupport& on, std::span<const float> weight, bool has_etendue,
           const std::string& why) {
    Projection p = project(rays, weight, on, tolerance_mm);
    append_chosen(missed, rays, weight, p.missed);
    p.missed = {};
    add(p, on.support, has_etendue, why);
  }

  void add_background(const BoundedSupport& best) {
    if (missed.empty()) return;
    const BoundedSupport rest = background_support(best, missed);
    Projection p = project(missed, missed.weight, rest, tolerance_mm);
    add(p, rest.support, true, "what the layers above do not carry");
    missed = {};
  }

  void add(Projection& p, const Support& support, bool has_etendue, const std::string& why) {
    if (has_etendue) widen(p, support, tolerance_mm);
    GrownLayer g =
        grown_layer(p, support, total_weight, setting.trees, kGrowShare * setting.penalty_nats, progress);
    if (g.layer.charts.empty()) return;
    g.layer.why = light + why;
    g.layer.band = band;
    grown.push_back(std::move(g));
  }
};

double sum_of(std::span<const float> weight) {
  double sum = 0.0;
  for (const float w : weight) sum += static_cast<double>(w);
  return sum;
}

/// The layers of one band of wavelengths: the best support, a second one that overlaps it if there is one,
/// and what is left.
void add_layers(LayerGrower& grower, std::span<const float> weight,
                std::span<const float> second_responsibility, const SearchResult& search,
                const std::optional<LayerSplit>& split) {
  const std::string why = fmt::format("{}; {} trees, {:.1f} nats a split", describe_choice(search),
                                      grower.setting.trees, grower.setting.penalty_nats);
  if (split) {
    std::vector<float> part(weight.size());
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = weight[i] * (1.0f - second_responsibility[i]);
    grower.add(search.best.on, part, true, why);
    for (std::size_t i = 0; i < part.size(); ++i) part[i] = weight[i] * second_responsibility[i];
    grower.add(split->second(), part, true,
               fmt::format("light that overlaps: {:.4f} +- {:.4f} nats per ray better than without",
                           split->gain_nats(), split->gain_error()));
  } else {
    grower.add(search.best.on, weight, !search.degenerate, why);
  }
  grower.add_background(search.best.on);
}

/// Above so many rays each goes to one of two layers as a whole, by chance: half the work, and noise that so
/// many rays do not show.
constexpr std::size_t kWholeRays = 4'500'000;

void assign_hard(std::vector<float>& part, std::uint64_t seed) {
  constexpr std::size_t kBlock = 1 << 14;
  parallel_blocks(part.size(), kBlock, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      if (part[i] > 0.0f && part[i] < 1.0f)
        part[i] = Rng(seed, i).uniform() < static_cast<double>(part[i]) ? 1.0f : 0.0f;
    }
  });
}

/// All layers of all bands.
std::vector<GrownLayer> grown_layers(const RayBlock& rays, std::span<const float> nm,
                                     const ColourBands& bands, const SearchResult& search,
                                     const std::optional<LayerSplit>& split, const Setting& setting,
                                     double tolerance_mm, std::uint64_t seed, Progress& progress) {
  LayerGrower grower{rays, setting, sum_of(rays.weight), tolerance_mm, progress};
  std::vector<float> second = split ? split->second_responsibilities(rays) : std::vector<float>{};
  if (rays.size() > kWholeRays) assign_hard(second, seed);
  if (bands.cuts_nm.empty()) add_layers(grower, rays.weight, second, search, split);
  for (std::uint32_t b = 0; b < bands.tables.size() && !bands.cuts_nm.empty(); ++b) {
    std::vector<float> weight(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) weight[i] = bands.band(nm[i]) == b ? rays.weight[i] : 0.0f;
    grower.band = b;
    grower.light =
        fmt::format("{:.0f} to {:.0f} nm; ", bands.tables[b].nm.front(), bands.tables[b].nm.back());
    if (sum_of(weight) > 0.0) add_layers(grower, weight, second, search, split);
  }
  double sum = 0.0;
  for (const GrownLayer& g : grower.grown) sum += g.layer.share;
  for (GrownLayer& g : grower.grown) g.layer.share /= sum;
  return std::move(grower.grown);
}

/// The rays' own wavelengths, or none where one of them has none.
std::vector<float> wavelengths_of(const RayBlock& rays, const RaySetHeader& header) {
  const RayWavelengths wavelengths(header, header.flux_unit);
  std::vector<float> nm;
  if (!wavelengths.differ_by_ray() || rays.extra.empty()) return nm;
  for (std::size_t i = 0; i < rays.size(); ++i) nm.push_back(wavelengths.of(rays, i, i));
  if (std::ranges::any_of(nm, [](float x) { return !(x > 0.0F); })) nm.clear();
  return nm;
}

void check_rays(const RayBlock& rays) {
  if (rays.empty()) throw InputError("no rays to compress");
  const bool any = std::any_of(rays.weight.begin(), rays.weight.end(), [](float w) { return w > 0.0f; });
  if (!any) throw InputError("the rays carry no flux: all weights are zero");
}

double model_flux(const RaySetHeader& header, const AdaptiveOptions& options) {
  const auto flux = options.flux ? options.flux : header.flux();
  if (!flux)
    throw InputError("the rays' total flux is not stated: it has to be given", ErrorCause::missing, "flux");
  if (!(*flux > 0.0) || !std::isfinite(*flux)) {
    throw InputError(fmt::format("total flux {}, expected > 0", *flux));
  }
  return *flux;
}

/// `rays` have no extra columns; `nm` are their wavelengths, if they have any.
std::unique_ptr<AdaptiveModel> compress(const RayBlock& rays, std::span<const float> nm,
                                        const RaySetHeader& header, const AdaptiveOptions& options,
                                        Progress& progress) {
  check_rays(rays);
  AdaptiveData data;
  data.flux = model_flux(header, options);
  data.flux_unit = header.flux_unit;
  data.training_rays = rays.size();
  if (nm.empty()) data.spectra = header.spectra;
  data.surface = starting_surface(rays);
  SearchResult search = search_support(rays, data.surface, options.seed, progress);
  polish(search, rays, options.seed, progress);
  const double tolerance = rounding_mm(rays, search.best.on.support.world_from_support.origin_mm());
  Setting setting;
  setting.trees = options.trees.value_or(default_trees(rays.size()));
  progress.step("compress: depth", 0, 1);
  setting.penalty_nats = options.penalty_nats.value_or(0.0);
  if (!options.penalty_nats) {
    const double likeliest = choose_penalty(rays, search.best.on, tolerance, setting.trees, options.seed + 3);
    setting.penalty_nats = std::max(kPenalties.front(), kDeeper * likeliest);
  }
  std::optional<LayerSplit> split;
  if (options.overlap) split = split_layers(rays, search, data.surface, options.seed + 4, progress);
  ColourBands bands;
  if (!nm.empty()) bands = colour_bands(rays, nm, search.best.on, tolerance, options.seed + 5);
  if (nm.empty() && header.wavelength_nm)
    bands.tables = {{{0.0f, 1.0f}, {*header.wavelength_nm, *header.wavelength_nm}}};
  const auto grown =
      grown_layers(rays, nm, bands, search, split, setting, tolerance, options.seed + 6, progress);
  data.wavelengths = bands.tables;
  fit_to_size(data, grown, setting, options.max_bytes.value_or(std::uint64_t{1} << 27));
  return std::make_unique<AdaptiveModel>(std::move(data));
}

}  // namespace

BoundingSurface starting_surface(const RayBlock& rays) {
  constexpr double kNearlyAll = 0.999;
  const SurfaceGuess guess = guess_surface(rays, kNearlyAll);
  if (guess.shape == StartShape::surface && guess.share >= kNearlyAll) return guess.surface;
  if (guess.shape == StartShape::point || guess.shape == StartShape::line) return {};
  const RaySummary summary = summarize(rays);
  const Vec3 low = *summary.extent_min_mm, high = *summary.extent_max_mm;
  const Vec3 size = high - low;
  const double min = 1e-6 * (size.x + size.y + size.z);
  BoundingSurface box =
      BoundingSurface::box({std::max(size.x, min), std::max(size.y, min), std::max(size.z, min)});
  box.world_from_surface = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.5 * (low + high));
  return box;
}

std::unique_ptr<AdaptiveModel> compress_adaptive(const RaySet& rays, const AdaptiveOptions& options,
                                                 Progress& progress) {
  const auto nm = wavelengths_of(rays.rays, rays.header);
  if (rays.rays.extra.empty()) {
    return compress(rays.rays, nm, rays.header, options, progress);
  }
  RayBlock plain = rays.rays;
  plain.extra.clear();
  return compress(plain, nm, rays.header, options, progress);
}

}  // namespace lucerna
