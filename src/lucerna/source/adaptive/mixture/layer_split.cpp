// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/mixture/layer_split.h"

#include <cmath>

#include "lucerna/core/parallel/parallel.h"
#include "lucerna/ray_statistics.h"
#include "lucerna/rayset/data/halves.h"

namespace lucerna {

/// Some rays in two halves: each is evaluated by densities made from the other.
struct SplitHalves {
  std::array<RayBlock, 2> rays;
  std::array<std::vector<double>, 2> plain;
};

namespace {

constexpr std::size_t kSplitRays = 60'000, kSplitBlock = 4096;
constexpr int kFirstSteps = 8, kSteps = 6;
/// Share of the plain density in every mixture, as in HeldOutScorer.
constexpr double kSplitBackgroundShare = 0.02;
/// Less light than this is left to the background.
constexpr double kMinLayerShare = 0.004;
/// The mixture must gain so many standard errors; and as much for each leaf that it has more than the first
/// support alone as a split of a tree must: some gain is had wherever two different trees are mixed.
constexpr double kClear = 4.0;

/// One number for each ray of each half.
using HalfNumbers = std::array<std::vector<double>, 2>;

double weight_of(const RayBlock& rays, std::size_t i) { return static_cast<double>(rays.weight[i]); }

template <class Density>
std::vector<double> densities(const RayBlock& rays, const Density& density) {
  std::vector<double> out(rays.size());
  parallel_blocks(rays.size(), kSplitBlock, [&](std::size_t a, std::size_t b) {
    density.densities(rays, a, std::span(out).subspan(a, b - a));
  });
  return out;
}

/// Nothing where a half is dark, as of a few rays.
std::optional<SplitHalves> halves_of(const RayBlock& rays, const Vec3& focus_mm, double tolerance_mm) {
  SplitHalves h{ray_halves(rays, 1), {}};
  if (!has_flux(h.rays[0]) || !has_flux(h.rays[1])) return std::nullopt;
  for (std::size_t k = 0; k < 2; ++k) {
    const RayBlock& other = h.rays[1 - k];
    h.plain[k] = densities(h.rays[k], BackgroundDensity(other, other.weight, focus_mm, tolerance_mm));
  }
  return h;
}

/// Rays' weights times their part in the second layer (`second`) or the first.
std::vector<float> parted(const RayBlock& rays, const std::vector<double>& part, bool second) {
  std::vector<float> weight(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) {
    weight[i] = static_cast<float>(weight_of(rays, i) * (second ? part[i] : 1.0 - part[i]));
  }
  return weight;
}

/// The posterior parts of two densities in the shares 1 - `share` and `share`; returns the second's new
/// share.
double expectation(const SplitHalves& h, const HalfNumbers& first, const HalfNumbers& second, double share,
                   HalfNumbers& part) {
  double sum = 0.0, weight = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    part[k].resize(h.rays[k].size());
    for (std::size_t i = 0; i < part[k].size(); ++i) {
      const double a = (1.0 - share) * first[k][i], b = share * second[k][i], w = weight_of(h.rays[k], i);
      part[k][i] = a + b > 0.0 ? b / (a + b) : 0.0;
      sum += w * part[k][i], weight += w;
    }
  }
  return weight > 0.0 ? sum / weight : 0.0;
}

/// Densities of each half, of the rays' parts in the first layer and, where there is one, in the second. All
/// at once.
using Fitted = std::array<FittedSupport, 2>;
std::vector<Fitted> maximisation(const SplitHalves& h, const HalfNumbers& part, const BoundedSupport& first,
                                 const BoundedSupport* second, double tolerance_mm) {
  std::vector<Fitted> layers(second ? 2 : 1);
  parallel_blocks(2 * layers.size(), 1, [&](std::size_t i, std::size_t) {
    const std::size_t layer = i / 2, k = i % 2;
    layers[layer][k] = FittedSupport(h.rays[k], parted(h.rays[k], part[k], layer == 1),
                                     layer == 0 ? first : *second, tolerance_mm);
  });
  return layers;
}

HalfNumbers crossed(const SplitHalves& h, const Fitted& fitted) {
  return {densities(h.rays[0], fitted[1]), densities(h.rays[1], fitted[0])};
}

/// Log density of every ray of a mixture with a little of the plain density in it.
HalfNumbers logs(const SplitHalves& h, const HalfNumbers& first, const HalfNumbers& second, double share) {
  HalfNumbers out;
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < h.rays[k].size(); ++i) {
      const double mixed = (1.0 - share) * first[k][i] + share * second[k][i];
      out[k].push_back(
          std::log((1.0 - kSplitBackgroundShare) * mixed + kSplitBackgroundShare * h.plain[k][i]));
    }
  }
  return out;
}

/// Weighted mean of b - a, and its standard error.
std::array<double, 2> gain(const SplitHalves& h, const HalfNumbers& a, const HalfNumbers& b) {
  double sum = 0.0, squares = 0.0, weight = 0.0, weight2 = 0.0;
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < a[k].size(); ++i) {
      const double w = weight_of(h.rays[k], i), d = b[k][i] - a[k][i];
      sum += w * d, squares += w * d * d, weight += w, weight2 += w * w;
    }
  }
  const double mean = sum / weight, variance = squares / weight - mean * mean;
  return {mean, std::sqrt(std::max(0.0, variance) * weight2) / weight};
}

}  // namespace

std::vector<float> LayerSplit::second_responsibilities(const RayBlock& rays) const {
  constexpr double kNearly = 0.02;
  std::vector<float> out(rays.size());
  parallel_blocks(rays.size(), kSplitBlock, [&](std::size_t first, std::size_t last) {
    RayBatch batch;
    ChartBatch lines;
    BatchColumn density;
    for (std::size_t at = first; at < last; at += kSupportBatch) {
      const std::size_t n = std::min(kSupportBatch, last - at);
      load_batch(rays, at, 1, n, batch);
      std::array<BatchColumn, 2> p{};
      for (std::size_t layer = 0; layer < 2; ++layer) {
        charts_of(densities_[layer].front().support(), batch, lines);
        for (const FittedSupport& f : densities_[layer]) {
          f.densities(lines, std::span(density).first(n));
          for (std::size_t i = 0; i < n; ++i) p[layer][i] += density[i];
        }
      }
      for (std::size_t i = 0; i < n; ++i) {
        const double a = (1.0 - second_share_) * p[0][i], b = second_share_ * p[1][i];
        double part = a + b > 0.0 ? b / (a + b) : 0.0;
        if (part < kNearly) part = 0.0;
        if (part > 1.0 - kNearly) part = 1.0;
        out[at + i] = static_cast<float>(part);
      }
    }
  });
  return out;
}

/// Two supports, and the rays shared out between them.
struct Mixture {
  BoundedSupport first, second;
  HalfNumbers part;  ///< of each ray, in the second
  double share = 0.0;
  std::vector<Fitted> fitted;
  HalfNumbers logs;  ///< log density of every ray
  double leaves = 0.0;
};

/// The first support alone, and what it leaves to a second.
struct LayerSplitter {
  const SplitHalves& halves;
  const BoundedSupport& first;
  double tolerance_mm;
  HalfNumbers alone, part;  // density of every ray; its part that light from anywhere explains better
  double leaves = 0.0, share = 0.0;

  LayerSplitter(const SplitHalves& h, const BoundedSupport& first_support, double tolerance)
      : halves(h), first(first_support), tolerance_mm(tolerance) {
    constexpr double kFirstGuess = 0.05;
    for (std::size_t k = 0; k < 2; ++k) part[k].assign(h.rays[k].size(), 0.0);
    const Fitted single = maximisation(h, part, first, nullptr, tolerance_mm).front();
    leaves = static_cast<double>(single[0].leaves() + single[1].leaves());
    alone = crossed(h, single);
    share = kFirstGuess;
    HalfNumbers one = alone;
    for (int step = 0; step < kFirstSteps; ++step) {
      share = expectation(h, one, h.plain, share, part);
      if (step % 3 == 2) one = crossed(h, maximisation(h, part, first, nullptr, tolerance_mm).front());
    }
  }

  /// Rays with what they have in the second layer (`second`) or the first as their weights.
  RayBlock rays_of(const HalfNumbers& parts, bool second) const {
    RayBlock own;
    for (std::size_t k = 0; k < 2; ++k) {
      RayBlock weighted = halves.rays[k];
      weighted.weight = parted(halves.rays[k], parts[k], second);
      own.append(weighted);
    }
    return own;
  }
  /// Rays, weighted by how badly the first support explains them.
  RayBlock odd_rays() const { return rays_of(part, true); }

  /// The rays shared out between two supports, from a first guess on.
  Mixture mixture(const BoundedSupport& one, const BoundedSupport& two, HalfNumbers parts, double its_share,
                  Progress& progress) const {
    Mixture m{one, two, std::move(parts), its_share, {}, {}, 0.0};
    HalfNumbers of_one, of_two;
    for (int step = 0; step < kSteps; ++step) {
      if (progress.stop_requested()) throw Interrupted();
      m.fitted = maximisation(halves, m.part, m.first, &m.second, tolerance_mm);
      of_one = crossed(halves, m.fitted[0]), of_two = crossed(halves, m.fitted[1]);
      m.share = expectation(halves, of_one, of_two, m.share, m.part);
    }
    m.logs = logs(halves, of_one, of_two, m.share);
    for (const Fitted& layer : m.fitted) {
      for (const FittedSupport& f : layer) m.leaves += static_cast<double>(f.leaves());
    }
    return m;
  }
  Mixture mixture(const BoundedSupport& second, Progress& progress) const {
    return mixture(first, second, part, share, progress);
  }

  /// Is a mixture clearly likelier than densities with `logs`, and worth its leaves beyond `leaves`?
  bool is_likelier(const Mixture& m, const HalfNumbers& other_logs, double other_leaves) const {
    const auto [nats, error] = gain(halves, other_logs, m.logs);
    const auto rays = static_cast<double>(halves.rays[0].size() + halves.rays[1].size());
    return m.share >= kMinLayerShare && nats >= kClear * error &&
           nats * rays > kQuickPenaltyNats * (m.leaves - other_leaves);
  }
  HalfNumbers logs_alone() const { return logs(halves, alone, alone, 0.0); }
  bool is_worth(const Mixture& m) const { return is_likelier(m, logs_alone(), leaves); }

  LayerSplit split_of(Mixture m) const {
    LayerSplit split;
    const auto [nats, error] = gain(halves, logs_alone(), m.logs);
    split.gain_nats_ = nats, split.gain_error_ = error, split.second_share_ = m.share;
    for (std::size_t layer = 0; layer < 2; ++layer)
      split.densities_[layer] = {m.fitted[layer][0], m.fitted[layer][1]};
    split.first_ = std::move(m.first), split.second_ = std::move(m.second);
    return split;
  }
};

namespace {

/// Searches for one of two supports with the rays that the mixture gives it, and takes what is found where
/// that makes the mixture clearly likelier: then true.
bool is_improved(const LayerSplitter& splitter, bool second, const BoundingSurface& surface,
                 std::uint64_t seed, Progress& progress, Mixture& best) {
  const RayBlock own = splitter.rays_of(best.part, second);
  SearchResult found = search_support(own, surface, seed, progress);
  if (found.degenerate) return false;
  const auto with = [&](const BoundedSupport& on) {
    return splitter.mixture(second ? best.first : on, second ? on : best.second, best.part, best.share,
                            progress);
  };
  // As above: before it is exact.
  Mixture better = with(found.best.on);
  if (!splitter.is_likelier(better, best.logs, best.leaves)) return false;
  polish(found, own, seed, progress);
  Mixture exact = with(found.best.on);
  best = splitter.is_likelier(exact, best.logs, best.leaves) ? std::move(exact) : std::move(better);
  return true;
}

/// Shares the rays out again and again, until the mixture hardly gains.
void settle(const LayerSplitter& splitter, Progress& progress, Mixture& best) {
  constexpr int kMost = 6;
  constexpr double kHardly = 0.002;
  for (int i = 0; i < kMost; ++i) {
    Mixture next = splitter.mixture(best.first, best.second, best.part, best.share, progress);
    const double nats = gain(splitter.halves, best.logs, next.logs)[0];
    if (nats > 0.0) best = std::move(next);
    if (nats < kHardly) return;
  }
}

}  // namespace

std::optional<LayerSplit> split_layers(const RayBlock& rays, const SearchResult& first,
                                       const BoundingSurface& surface, std::uint64_t seed,
                                       Progress& progress) {
  constexpr std::uint64_t kRounds = 3;
  if (first.degenerate) return std::nullopt;
  const RayBlock some = stratified_choice(rays, kSplitRays, seed);
  const RaySummary summary = summarize(some);
  const Vec3 focus_mm = summary.virtual_focus ? summary.virtual_focus->point_mm : Vec3{};
  const double tolerance_mm = rounding_mm(some, focus_mm);
  const std::optional<SplitHalves> both = halves_of(some, focus_mm, tolerance_mm);
  if (!both) return std::nullopt;
  const LayerSplitter splitter(*both, first.best.on, tolerance_mm);
  if (splitter.share < kMinLayerShare) return std::nullopt;
  const RayBlock odd = splitter.odd_rays();
  SearchResult found = search_support(odd, surface, seed + 1, progress);
  // Most of what is odd is no second source: that shows before the support is exact.
  if (found.degenerate || !splitter.is_worth(splitter.mixture(found.best.on, progress))) return std::nullopt;
  polish(found, odd, seed + 1, progress);
  Mixture best = splitter.mixture(found.best.on, progress);
  if (!splitter.is_worth(best)) return std::nullopt;
  for (std::uint64_t round = 0, changed = 1; round < kRounds && changed > 0; ++round) {
    changed = 0;
    for (const bool second : {false, true})
      changed += is_improved(splitter, second, surface, seed + 2 + round, progress, best) ? 1 : 0;
  }
  settle(splitter, progress, best);
  return splitter.split_of(std::move(best));
}

}  // namespace lucerna
