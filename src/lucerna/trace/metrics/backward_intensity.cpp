// SPDX-License-Identifier: Apache-2.0
#include "lucerna/trace/metrics/backward_intensity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>
#include <numeric>

#include "lucerna/trace/backward/backward_estimator.h"
#include "lucerna/trace/result/node_noise.h"

namespace lucerna {

namespace {

/// Backward and counted flux may be this many errors apart, or this share of each other.
constexpr double kMaxErrors = 4.0, kMaxShare = 0.005;
/// Of light behind a cover glass, an error of this share is that of light which samples find by chance: what
/// the glass sends back into a narrow spike. A beam of a tenth of a degree in a cell of three degrees has
/// less.
constexpr double kMaxNoise = 0.3;
constexpr std::uint64_t kCheckSamples = 1024;

/// Whole cells of a grid: planes [c, c + planes) and gammas [g, g + gammas).
struct CellBlock {
  std::size_t c, planes, g, gammas;
};

/// About as wide as it is high: three gammas about `g`, and as many planes about `c`.
CellBlock block_about(const FarField& f, std::size_t c, std::size_t g) {
  const std::size_t first = g == 0 ? 0 : g - 1, last = std::min(f.gamma_count - 1, g + 1);
  const double sine = std::max(1e-9, std::sin(radians(f.gamma_step_deg * static_cast<double>(g))));
  const double wanted = 3.0 * f.gamma_step_deg / (sine * f.c_step_deg);
  const auto planes = static_cast<std::size_t>(std::clamp(wanted, 1.0, static_cast<double>(f.c_count)));
  return {(c + f.c_count - planes / 2) % f.c_count, planes, first, last - first + 1};
}

DirectionCell cell_of(const FarField& f, const CellBlock& b) {
  const double c_step = radians(f.c_step_deg), gamma_step = radians(f.gamma_step_deg);
  const double c0 = c_step * (static_cast<double>(b.c) - 0.5);
  const double gamma0 = gamma_step * (static_cast<double>(b.g) - 0.5);
  return {c0, c0 + c_step * static_cast<double>(b.planes), std::max(0.0, gamma0),
          std::min(std::numbers::pi, gamma0 + gamma_step * static_cast<double>(b.gammas))};
}

Estimate counted_flux(const CountedFarField& f, const CellBlock& b) {
  Jackknife sum(f.replicated.replicates());
  for (std::size_t i = 0; i < b.planes; ++i) {
    for (std::size_t k = 0; k < b.gammas; ++k)
      sum.add(1.0, f.replicated.row((b.c + i) % f.c_count * f.gamma_count + b.g + k));
  }
  return sum.estimate();
}

Estimate backward_flux(const BackwardEstimator& estimator, const DirectionCell& cell) {
  std::array<std::uint64_t, 16> seeds;
  std::iota(seeds.begin(), seeds.end(), std::uint64_t{1});
  return mean_estimate(estimator.cell_flux(cell, 1, 1, kCheckSamples, seeds));
}

bool agree(const BackwardEstimator& estimator, const CountedFarField& f, const CellBlock& block,
           bool behind_glass) {
  const Estimate counted = counted_flux(f, block), backward = backward_flux(estimator, cell_of(f, block));
  const double gap = std::abs(counted.mean - backward.mean);
  const double both_errors = std::hypot(counted.standard_error, backward.standard_error);
  const bool by_chance =
      behind_glass &&
      backward.standard_error > std::max(kMaxNoise * counted.mean, kMaxErrors * counted.standard_error);
  return gap <= kMaxErrors * both_errors + kMaxShare * counted.mean && !by_chance;
}

}  // namespace

PointIntensity backward_intensity(const Scene& scene, int max_bounces, std::uint64_t run_seed,
                                  const CountedFarField& field, const StopCheck& stop) {
  if (!no_backward_reason(scene).empty() || field.tent || field.replicated.replicates() < 2) return {};
  const auto estimator = std::make_shared<const BackwardEstimator>(scene, max_bounces);
  const std::vector<double> cd = node_intensity(field).distribution.cd;
  const auto brightest = static_cast<std::size_t>(std::max_element(cd.begin(), cd.end()) - cd.begin());
  const std::size_t pole = cd.front() >= cd.at(field.gamma_count - 1) ? 0 : field.gamma_count - 1;
  for (const CellBlock& block :
       {block_about(field, brightest / field.gamma_count, brightest % field.gamma_count),
        block_about(field, 0, pole)}) {
    if (!agree(*estimator, field, block, !scene.glasses.empty())) return {};
  }
  return [estimator, run_seed, &stop](const Direction& d, std::uint64_t samples, std::uint64_t seed) {
    stop();
    return estimator->intensity_cd(d, samples, 16, detail::mix_bits(run_seed) + seed);
  };
}

}  // namespace lucerna
