// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/compression/adaptive_compress.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "lucerna/core/io/error.h"
#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/data/ray_wavelengths.h"
#include "lucerna/rayset/statistics/surface_guess.h"
#include "lucerna/source/adaptive/compression/exact_trees.h"
#include "lucerna/source/adaptive/compression/grown_layers.h"
#include "lucerna/source/adaptive/compression/layer_recount.h"
#include "lucerna/source/adaptive/mixture/penalty_choice.h"
#include "lucerna/source/adaptive/search/support_search.h"
#include "lucerna/source/file/nfl.h"

namespace lucerna {

namespace {

/// Views sum over much of the four dimensions, where noise averages out and blur does not: they want deeper
/// trees than the likelihood of single rays does (docs/theory/source-model.md, "Depth").
constexpr double kDeeper = 0.7;

/// More trees smooth what few rays leave rough; many rays need less smoothing and cost time.
int default_trees(std::size_t rays) {
  if (rays <= 250'000) return 16;
  if (rays <= 1'000'000) return 8;
  if (rays <= 4'500'000) return 4;
  return 2;
}

std::vector<DensityTree> pruned_trees(const std::vector<GrownTree>& from, const TreeBox& box, double penalty,
                                      int trees, const TreeMarginals* calibration) {
  ExactTrees exact = exact_trees(from, box, penalty, static_cast<std::size_t>(trees), calibration);
  parallel_blocks(exact.trees.size(), 1, [&](std::size_t t, std::size_t) {
    exact.trees[t] = settled({std::move(exact.trees[t]), std::move(exact.leaf_shares[t])});
  });
  return std::move(exact.trees);
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
void fit_to_size(AdaptiveData& data, const std::vector<GrownLayer>& grown, const TreeSetting& setting,
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
  TreeSetting setting;
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
  if (!nm.empty())
    bands = colour_bands(rays, nm, split ? split->first() : search.best.on, tolerance, options.seed + 5);
  if (nm.empty() && header.wavelength_nm)
    bands.tables = {{{0.0f, 1.0f}, {*header.wavelength_nm, *header.wavelength_nm}}};
  const LightParts parts{search, split, bands, tolerance, options.seed + 6};
  std::vector<GrownLayer> grown = grown_layers(rays, nm, parts, setting, progress);
  if (options.all_rays) data.training_rays = recount(grown, parts, options.all_rays);
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
