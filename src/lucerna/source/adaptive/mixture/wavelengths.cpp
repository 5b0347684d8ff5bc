// SPDX-License-Identifier: Apache-2.0
#include "lucerna/source/adaptive/mixture/wavelengths.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/source/adaptive/search/fitted_support.h"

namespace lucerna {

namespace {

constexpr std::size_t kMaxBands = 6, kMaxLines = 64, kParts = 64, kBandRays = 60'000;

/// Numbers of the values with weight, in ascending order of the values.
std::vector<std::size_t> ascending(std::span<const float> nm, std::span<const float> weight) {
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < nm.size(); ++i) {
    if (weight[i] > 0.0f) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return nm[a] < nm[b]; });
  return order;
}

/// Ends of at most kMaxBands bands.
std::vector<float> band_ends(const WavelengthTable& all) {
  std::vector<float> ends;
  const bool lines = all.nm.size() <= 2 * kMaxBands;
  for (std::size_t k = 1; k < kMaxBands && !lines; ++k) {
    ends.push_back(all.at(static_cast<double>(k) / static_cast<double>(kMaxBands)));
  }
  for (std::size_t i = 2; lines && i < all.nm.size(); i += 2) {
    ends.push_back(0.5f * (all.nm[i - 1] + all.nm[i]));
  }
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

/// Do the lines of rays foretell their bands? Bands `band` of `rays`; every third ray is held out.
bool predicted_by_bands(const RayBlock& rays, const std::vector<std::size_t>& band, std::size_t bands,
                        const BoundedSupport& on, double tolerance_mm) {
  constexpr double kClearGain = 4.0, kMinGain = 0.002, kRatioFloor = 0.05;
  std::vector<std::vector<double>> density;
  std::vector<double> share(bands, 0.0);
  double total = 0.0;
  for (std::size_t b = 0; b < bands; ++b) {
    std::vector<float> weight(rays.size(), 0.0f);
    for (std::size_t i = 0; i < rays.size(); ++i) {
      if (i % 3 != 2 && band[i] == b) weight[i] = rays.weight[i], share[b] += static_cast<double>(weight[i]);
    }
    total += share[b];
    FittedSupport(rays, weight, on, tolerance_mm).densities(rays, 0, density.emplace_back(rays.size()));
  }
  double sum = 0.0, squares = 0.0, weight = 0.0, weight2 = 0.0;
  for (std::size_t i = 2; i < rays.size(); i += 3) {
    std::vector<double> p(bands);
    for (std::size_t b = 0; b < bands; ++b) p[b] = share[b] / total * density[b][i];
    const double all = std::accumulate(p.begin(), p.end(), 0.0), w = static_cast<double>(rays.weight[i]);
    const double before = share[band[i]] / total;
    if (!(before > 0.0)) continue;
    const double ratio = all > 0.0 ? p[band[i]] / all / before : 1.0;
    const double gain = std::log((1.0 - kRatioFloor) * ratio + kRatioFloor);
    sum += w * gain, squares += w * gain * gain, weight += w, weight2 += w * w;
  }
  if (!(weight > 0.0)) return false;
  const double mean = sum / weight, variance = std::max(0.0, squares / weight - mean * mean);
  return mean > kMinGain && mean > kClearGain * std::sqrt(variance * weight2) / weight;
}

}  // namespace

float WavelengthTable::at(double u) const {
  const auto above = std::upper_bound(share.begin(), share.end(), static_cast<float>(u));
  const auto k = static_cast<std::size_t>(
      std::clamp<std::ptrdiff_t>(above - share.begin(), 1, static_cast<std::ptrdiff_t>(share.size()) - 1));
  const double width = static_cast<double>(share[k]) - static_cast<double>(share[k - 1]);
  const double t = width > 0.0 ? std::clamp((u - static_cast<double>(share[k - 1])) / width, 0.0, 1.0) : 0.0;
  const auto low = static_cast<double>(nm[k - 1]), high = static_cast<double>(nm[k]);
  return static_cast<float>(low + t * (high - low));
}

WavelengthTable wavelength_table(std::span<const float> nm, std::span<const float> weight) {
  const std::vector<std::size_t> order = ascending(nm, weight);
  LUCERNA_CHECK(!order.empty(), "a table of {} wavelengths without weight", nm.size());
  double total = 0.0;
  std::size_t distinct = 0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    total += static_cast<double>(weight[order[i]]);
    distinct += i == 0 || nm[order[i]] != nm[order[i - 1]] ? 1 : 0;
  }
  WavelengthTable table;
  const bool lines = distinct <= kMaxLines;
  double below = 0.0;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const float value = nm[order[i]];
    const bool first = i == 0 || value != nm[order[i - 1]];
    const double next = static_cast<double>(table.nm.size()) / static_cast<double>(kParts);
    if (lines ? first : below / total >= next || i == 0) {
      // The end of the line before is the start of this one.
      if (lines && i > 0)
        table.share.push_back(static_cast<float>(below / total)), table.nm.push_back(nm[order[i - 1]]);
      table.share.push_back(static_cast<float>(below / total));
      table.nm.push_back(value);
    }
    below += static_cast<double>(weight[order[i]]);
  }
  table.share.push_back(1.0f);
  table.nm.push_back(nm[order.back()]);
  return table;
}

std::size_t ColourBands::band(float nm) const {
  return static_cast<std::size_t>(std::lower_bound(cuts_nm.begin(), cuts_nm.end(), nm) - cuts_nm.begin());
}

ColourBands colour_bands(const RayBlock& rays, std::span<const float> nm, const BoundedSupport& on,
                         double tolerance_mm, std::uint64_t seed) {
  ColourBands bands;
  const WavelengthTable all = wavelength_table(nm, rays.weight);
  bands.cuts_nm = band_ends(all);
  const std::size_t n = bands.cuts_nm.size() + 1;
  if (n > 1) {
    const std::size_t some = std::min(rays.size(), kBandRays);
    const double stretch = static_cast<double>(rays.size()) / static_cast<double>(some);
    RayBlock chosen;
    std::vector<std::size_t> band;
    chosen.resize(0, rays.extra.size());
    for (std::size_t i = 0; i < some; ++i) {
      const double place = (static_cast<double>(i) + Rng(seed, i).uniform()) * stretch;
      const std::size_t k = std::min(static_cast<std::size_t>(place), rays.size() - 1);
      chosen.append(rays, k);
      band.push_back(bands.band(nm[k]));
    }
    if (!predicted_by_bands(chosen, band, n, on, tolerance_mm)) bands.cuts_nm.clear();
  }
  if (bands.cuts_nm.empty()) {
    bands.tables = {all};
    return bands;
  }
  for (std::size_t b = 0; b < n; ++b) {
    std::vector<float> weight(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i) weight[i] = bands.band(nm[i]) == b ? rays.weight[i] : 0.0f;
    const bool any = std::any_of(weight.begin(), weight.end(), [](float w) { return w > 0.0f; });
    bands.tables.push_back(any ? wavelength_table(nm, weight) : all);
  }
  return bands;
}

}  // namespace lucerna
