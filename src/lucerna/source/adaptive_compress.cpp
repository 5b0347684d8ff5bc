// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive_compress.h"

#include <algorithm>
#include <cmath>

#include "lucerna/core/error.h"
#include "lucerna/core/random.h"
#include "lucerna/rayset/ray_statistics.h"
#include "lucerna/rayset/surface_guess.h"
#include "lucerna/source/penalty_choice.h"
#include "lucerna/source/support_search.h"

namespace lucerna {

namespace {

/// Charts with less of the flux than this are dropped, and their flux given to the others.
constexpr double kSmallestShare = 1e-7;
/// Trees are grown a little further than they are kept, so that splits which pay later are found.
constexpr double kGrowShare = 0.7;

/// Views sum over much of the four dimensions, where noise averages out and blur does not: they want deeper
/// trees than the likelihood of single rays does (docs/algorithms/adaptive.md has the figures).
constexpr double kDeeper = 0.7;

/// A layer whose trees are grown and not yet pruned.
struct GrownLayer {
  AdaptiveLayer layer;  // charts without nodes
  std::vector<std::vector<GrownTree>> trees;
};

struct Setting {
  int trees = 1;
  double penalty_nats = 6.0;
};

/// More trees smooth what few rays leave rough; many rays need less smoothing and cost time.
int default_trees(std::size_t rays) {
  if (rays <= 250'000) return 16;
  if (rays <= 1'000'000) return 8;
  if (rays <= 4'500'000) return 4;
  return 2;
}

GrownLayer grown_layer(Projection& p, const Support& support, double total_weight, int trees, double penalty,
                       Progress& progress) {
  GrownLayer grown;
  grown.layer.support = support;
  grown.layer.share = p.weight / total_weight;
  for (ChartItems& c : p.charts) {
    if (c.weight < kSmallestShare * total_weight) continue;
    grown.layer.charts.push_back({c.chart, c.weight, c.box, {}});
    auto& grown_trees = grown.trees.emplace_back();
    for (int t = 0; t < trees; ++t) {
      progress.step("compress: trees", static_cast<std::uint64_t>(t), static_cast<std::uint64_t>(trees));
      grown_trees.push_back(grow_tree(
          c.items, c.box,
          {.penalty_nats = penalty, .tree_number = static_cast<std::uint64_t>(t), .coarse_cuts = trees > 1}));
    }
    c.items = {};
  }
  double sum = 0.0;
  for (const AdaptiveChart& c : grown.layer.charts) sum += c.share;
  for (AdaptiveChart& c : grown.layer.charts) c.share /= sum;
  return grown;
}

/// The file's size with every tree pruned by `penalty`, and the layers themselves.
std::vector<AdaptiveLayer> pruned(const std::vector<GrownLayer>& grown, double penalty, int trees) {
  std::vector<AdaptiveLayer> layers;
  for (const GrownLayer& g : grown) {
    layers.push_back(g.layer);
    for (std::size_t i = 0; i < g.trees.size(); ++i) {
      for (std::size_t t = 0; t < std::min<std::size_t>(g.trees[i].size(), static_cast<std::size_t>(trees));
           ++t) {
        layers.back().charts[i].trees.push_back(prune_tree(g.trees[i][t], penalty));
      }
    }
  }
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

/// Prunes until the file fits: first by penalty, then with fewer trees.
void fit_to_size(AdaptiveData& data, const std::vector<GrownLayer>& grown, const Setting& setting,
                 std::uint64_t max_bytes) {
  for (int trees = setting.trees;; trees /= 2) {
    double low = setting.penalty_nats, high = low;
    data.layers = pruned(grown, low, trees);
    if (file_bytes(data) <= max_bytes) return;
    // Rougher trees than this are worse than fewer of them.
    const double most = trees > 1 ? 3.0 * setting.penalty_nats : 1e9;
    do {
      low = high;
      high = std::min(most, 2.0 * high);
      data.layers = pruned(grown, high, trees);
    } while (file_bytes(data) > max_bytes && high < most);
    if (file_bytes(data) > max_bytes) {
      if (trees > 1) continue;
      throw InputError(fmt::format("a model of these rays does not fit in {} bytes", max_bytes));
    }
    for (int i = 0; i < 6; ++i) {
      const double middle = std::sqrt(low * high);
      data.layers = pruned(grown, middle, trees);
      (file_bytes(data) <= max_bytes ? high : low) = middle;
    }
    data.layers = pruned(grown, high, trees);
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
  std::array<std::array<bool, kSupportKinds>, 2> told{};
  told[dome.exists() ? 1 : 0][static_cast<std::size_t>(search.best.on.support.kind)] = true;
  for (const SupportScore& rival : search.rivals) {
    const Support& s = rival.on.support;
    bool& known = told[s.dome.exists() ? 1 : 0][static_cast<std::size_t>(s.kind)];
    if (known) continue;
    known = true;
    text += fmt::format("; {:.3f} better than {}{}", search.coarse_nats - rival.nats, to_string(s.kind),
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

RayBlock chosen_rays(const RayBlock& rays, const std::vector<std::uint32_t>& which) {
  RayBlock out;
  for (const std::uint32_t i : which) out.append(rays, i);
  return out;
}

void check_rays(const RayBlock& rays) {
  if (rays.empty()) throw InputError("no rays to compress");
  const bool any = std::any_of(rays.weight.begin(), rays.weight.end(), [](float w) { return w > 0.0f; });
  if (!any) throw InputError("the rays carry no flux: all weights are zero");
}

double model_flux(const RaySetHeader& header, const AdaptiveOptions& options) {
  const auto flux = options.flux ? options.flux : header.flux();
  if (!flux) throw InputError("the rays' total flux is not stated; give it with --flux");
  if (!(*flux > 0.0) || !std::isfinite(*flux)) {
    throw InputError(fmt::format("total flux {}, expected > 0", *flux));
  }
  return *flux;
}

std::unique_ptr<AdaptiveModel> compress(const RayBlock& rays, const RaySetHeader& header, std::uint64_t count,
                                        const AdaptiveOptions& options, Progress& progress) {
  check_rays(rays);
  AdaptiveData data;
  data.flux = model_flux(header, options);
  data.flux_unit = header.flux_unit;
  data.training_rays = count;
  data.spectra = header.spectra;
  data.surface = starting_surface(rays);
  const SearchResult search = find_support(rays, data.surface, options.seed, progress);
  const double tolerance = rounding_mm(rays, search.best.on.support.world_from_support.origin_mm());
  Setting setting;
  setting.trees = options.trees.value_or(default_trees(rays.size()));
  progress.step("compress: depth", 0, 1);
  setting.penalty_nats = options.penalty_nats.value_or(0.0);
  if (!options.penalty_nats) {
    const double likeliest = choose_penalty(rays, search.best.on, tolerance, setting.trees, options.seed + 3);
    setting.penalty_nats = std::max(kPenalties.front(), kDeeper * likeliest);
  }
  std::vector<GrownLayer> grown;
  Projection p = project(rays, rays.weight, search.best.on, tolerance);
  const double total = p.weight + p.missed_weight, penalty = kGrowShare * setting.penalty_nats;
  const RayBlock missed = chosen_rays(rays, p.missed);
  if (!search.degenerate) widen(p, search.best.on.support, tolerance);
  p.missed = {};
  grown.push_back(grown_layer(p, search.best.on.support, total, setting.trees, penalty, progress));
  grown.back().layer.why = fmt::format("{}; {} trees, {:.1f} nats a split", describe_choice(search),
                                       setting.trees, setting.penalty_nats);
  if (missed.size() > 0) {
    const BoundedSupport rest = background_support(search.best.on, missed);
    Projection q = project(missed, missed.weight, rest, tolerance);
    widen(q, rest.support, tolerance);
    grown.push_back(grown_layer(q, rest.support, total, setting.trees, penalty, progress));
    grown.back().layer.why = "what the layers above do not carry";
  }
  if (grown.back().layer.charts.empty()) grown.pop_back();
  double sum = 0.0;
  for (const GrownLayer& g : grown) sum += g.layer.share;
  for (GrownLayer& g : grown) g.layer.share /= sum;
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
  const double least = 1e-6 * (size.x + size.y + size.z);
  BoundingSurface box =
      BoundingSurface::box({std::max(size.x, least), std::max(size.y, least), std::max(size.z, least)});
  box.world_from_surface = Frame({1, 0, 0}, {0, 1, 0}, {0, 0, 1}, 0.5 * (low + high));
  return box;
}

std::unique_ptr<AdaptiveModel> compress_adaptive(const RaySet& rays, const AdaptiveOptions& options,
                                                 Progress& progress) {
  return compress(rays.rays, rays.header, rays.rays.size(), options, progress);
}

std::unique_ptr<AdaptiveModel> compress_adaptive(RayReader& reader, const AdaptiveOptions& options,
                                                 Progress& progress) {
  const std::uint64_t count = reader.ray_count(), kept = std::min(count, kMostTrainingRays);
  RayBlock rays, block;
  std::uint64_t read = 0, next = 0;
  const auto place_of = [&](std::uint64_t i) {
    if (kept == count) return i;
    const double stretch = static_cast<double>(count) / static_cast<double>(kept);
    return static_cast<std::uint64_t>((static_cast<double>(i) + Rng(options.seed, i).uniform()) * stretch);
  };
  std::uint64_t wanted = place_of(0);
  while (const std::size_t n = reader.read(block, kStreamBlock)) {
    block.extra.clear();
    if (kept == count) rays.append(block);
    for (; kept < count && next < kept && wanted < read + n; wanted = place_of(++next)) {
      rays.append(block, static_cast<std::size_t>(wanted - read));
    }
    read += n;
    progress.step("compress: read", read, count);
  }
  return compress(rays, reader.header(), count, options, progress);
}

}  // namespace lucerna
