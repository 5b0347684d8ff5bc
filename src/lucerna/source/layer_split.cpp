// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/layer_split.h"

#include <cmath>

#include "lucerna/core/parallel.h"
#include "lucerna/rayset/ray_statistics.h"

namespace lucerna {

namespace {

constexpr std::size_t kRays = 60'000, kBlock = 4096;
constexpr int kFirstSteps = 8, kSteps = 6;
/// Share of the plain density in every mixture, as in SupportJudge.
constexpr double kPlainShare = 0.02;
/// Less light than this is left to the background.
constexpr double kLeastShare = 0.004;
/// The mixture must gain so many standard errors; and as much for each leaf that it has more than the first
/// support alone as a split of a tree must: some gain is had wherever two different trees are mixed.
constexpr double kClear = 4.0;

/// Some rays in two halves: each is judged by densities made from the other.
struct Halves {
  std::array<RayBlock, 2> rays;
  std::array<std::vector<double>, 2> plain;
};

/// One number for each ray of each half.
using Numbers = std::array<std::vector<double>, 2>;

double weight_of(const RayBlock& rays, std::size_t i) { return static_cast<double>(rays.weight[i]); }

template <class Density>
std::vector<double> densities(const RayBlock& rays, const Density& density) {
  std::vector<double> out(rays.size());
  parallel_blocks(rays.size(), kBlock, [&](std::size_t a, std::size_t b) {
    density.densities(rays, a, std::span(out).subspan(a, b - a));
  });
  return out;
}

Halves halves_of(const RayBlock& rays, const Vec3& focus_mm, double tolerance_mm) {
  Halves h;
  for (std::size_t i = 0; i < rays.size(); ++i) h.rays[i % 2].append(rays, i);
  for (std::size_t k = 0; k < 2; ++k) {
    const RayBlock& other = h.rays[1 - k];
    h.plain[k] = densities(h.rays[k], PlainDensity(other, other.weight, focus_mm, tolerance_mm));
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
double expectation(const Halves& h, const Numbers& first, const Numbers& second, double share,
                   Numbers& part) {
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

/// A density of each half, of the rays' parts in one layer.
std::array<FittedSupport, 2> maximisation(const Halves& h, const Numbers& part, bool second,
                                          const BoundedSupport& on, double tolerance_mm) {
  const auto fit = [&](std::size_t k) {
    return FittedSupport(h.rays[k], parted(h.rays[k], part[k], second), on, tolerance_mm);
  };
  return {fit(0), fit(1)};
}

Numbers crossed(const Halves& h, const std::array<FittedSupport, 2>& fitted) {
  return {densities(h.rays[0], fitted[1]), densities(h.rays[1], fitted[0])};
}

/// Log density of every ray of a mixture with a little of the plain density in it.
Numbers logs(const Halves& h, const Numbers& first, const Numbers& second, double share) {
  Numbers out;
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < h.rays[k].size(); ++i) {
      const double mixed = (1.0 - share) * first[k][i] + share * second[k][i];
      out[k].push_back(std::log((1.0 - kPlainShare) * mixed + kPlainShare * h.plain[k][i]));
    }
  }
  return out;
}

/// Weighted mean of b - a, and its standard error.
std::array<double, 2> gain(const Halves& h, const Numbers& a, const Numbers& b) {
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

std::vector<float> LayerSplit::second_parts(const RayBlock& rays) const {
  constexpr double kNearly = 0.02;
  std::vector<float> out(rays.size());
  parallel_blocks(rays.size(), kBlock, [&](std::size_t first, std::size_t last) {
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

std::optional<LayerSplit> split_layers(const RayBlock& rays, const SearchResult& first,
                                       const BoundingSurface& surface, std::uint64_t seed,
                                       Progress& progress) {
  if (first.degenerate) return std::nullopt;
  const RayBlock some = stratified_choice(rays, kRays, seed);
  const RaySummary summary = summarize(some);
  const Vec3 focus_mm = summary.virtual_focus ? summary.virtual_focus->point_mm : Vec3{};
  const double tolerance_mm = rounding_mm(some, focus_mm);
  const Halves h = halves_of(some, focus_mm, tolerance_mm);
  Numbers part;
  for (std::size_t k = 0; k < 2; ++k) part[k].assign(h.rays[k].size(), 0.0);
  const auto single = maximisation(h, part, false, first.best.on, tolerance_mm);
  const Numbers alone = crossed(h, single);
  double more_leaves = -static_cast<double>(single[0].leaves() + single[1].leaves());
  // Against light from anywhere: what does the first support explain badly?
  double share = 0.05;
  Numbers one = alone;
  for (int step = 0; step < kFirstSteps; ++step) {
    share = expectation(h, one, h.plain, share, part);
    if (step % 3 == 2) one = crossed(h, maximisation(h, part, false, first.best.on, tolerance_mm));
  }
  if (share < kLeastShare) return std::nullopt;
  RayBlock odd;
  for (std::size_t k = 0; k < 2; ++k) {
    RayBlock weighted = h.rays[k];
    weighted.weight = parted(h.rays[k], part[k], true);
    odd.append(weighted);
  }
  const auto with = [&](const BoundedSupport& second) -> std::optional<LayerSplit> {
    LayerSplit split;
    split.second_ = second;
    Numbers its_part = part, two;
    double its_share = share, leaves = more_leaves;
    for (int step = 0; step < kSteps; ++step) {
      if (progress.stop_requested()) throw Interrupted();
      const auto a = maximisation(h, its_part, false, first.best.on, tolerance_mm);
      const auto b = maximisation(h, its_part, true, second, tolerance_mm);
      one = crossed(h, a), two = crossed(h, b);
      its_share = expectation(h, one, two, its_share, its_part);
      if (step < kSteps - 1) continue;
      split.densities_ = {{{a[0], a[1]}, {b[0], b[1]}}};
      for (std::size_t k = 0; k < 2; ++k) leaves += static_cast<double>(a[k].leaves() + b[k].leaves());
    }
    const auto [nats, error] = gain(h, logs(h, alone, two, 0.0), logs(h, one, two, its_share));
    const bool worth = nats * static_cast<double>(some.size()) > kQuickPenaltyNats * leaves;
    if (its_share < kLeastShare || nats < kClear * error || !worth) return std::nullopt;
    split.gain_nats_ = nats, split.gain_error_ = error, split.second_share_ = its_share;
    return split;
  };
  SearchResult found = search_support(odd, surface, seed + 1, progress);
  // Most of what is odd is no second source: that shows before the support is exact.
  if (found.degenerate || !with(found.best.on)) return std::nullopt;
  polish(found, odd, seed + 1, progress);
  return with(found.best.on);
}

}  // namespace lucerna
