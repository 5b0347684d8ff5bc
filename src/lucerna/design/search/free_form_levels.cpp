// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/search/free_form_levels.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "lucerna/design/search/free_form_state.h"

namespace lucerna {

namespace {

/// Of the derivatives' noise over the rest. A wide source lights many bins through each cell of knots, by few
/// rays each: their noise then damps every step. Coarser bins hold more rays, and such a source blurs what is
/// finer than they are.
constexpr double kMaxDerivativeNoise = 0.3;
/// Fewer of a level's rays have derivatives as long as no more than this of them is noise, over the rest:
/// such steps take half the time, and lead as far. At most by this factor, for then light takes most of the
/// time.
constexpr double kDerivativeNoise = 0.06;
constexpr unsigned kMaxFewer = 8;
constexpr std::uint64_t kMinDerivativeRays = std::uint64_t{1} << 18;
/// Least share of a level's bins, along each side.
constexpr double kMinBins = 0.6;
/// Share of its weight that roughness has on such a level: all of it costs as much there as an error of two
/// per cent, and with a tenth ripples hide in the coarser bins.
constexpr double kWideSmoothing = 0.3;
/// How finely each level fits; knots, smoothing and zones are the search's.
const std::array<FreeFormLevel, kFreeFormLevels> kLevel{{
    {.bins = 64, .rays = 1 << 18, .max_steps = 8, .min_gain = 0.1},
    {.bins = 84, .rays = 1 << 20, .max_steps = 25, .min_gain = 0.05},
    {.bins = 108, .rays = 1 << 22, .max_steps = 25, .min_gain = 0.015},
    {.bins = 120, .rays = 1 << 23, .max_steps = 40, .min_gain = 0.005},
}};

}  // namespace

FreeFormLevel free_form_level(int number) { return kLevel[static_cast<std::size_t>(number)]; }

FreeFormLevel with_bins(FreeFormLevel level, int bins) {
  if (bins < level.bins) level.smoothing *= kWideSmoothing;
  level.bins = bins;
  return level;
}

FreeFormLevel for_noise(FreeFormLevel l, double noise) {
  // 1 without noise.
  const double share = std::clamp(std::sqrt(kMaxDerivativeNoise / noise), kMinBins, 1.0);
  l = with_bins(l, static_cast<int>(std::lround(l.bins * share)));
  unsigned fewer = kMaxFewer;
  while (fewer > 1 && fewer * noise * share * share > kDerivativeNoise) fewer /= 2;
  l.derivative_rays = std::min(l.rays, std::max(l.rays / fewer, kMinDerivativeRays));
  return l;
}

}  // namespace lucerna
