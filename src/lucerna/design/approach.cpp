// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/approach.h"

#include <algorithm>

#include "lucerna/core/random.h"

namespace lucerna {

namespace {

/// Rays of all evaluations, at most; and how many evaluations of the most rays.
constexpr std::uint64_t kMaxRays = std::uint64_t{1} << 23, kMaxEvaluations = 64;
/// Random streams of perturbed starts begin here.
constexpr std::uint64_t kStream = std::uint64_t{1} << 34;

/// The stages up to the gate, where an approach ends.
std::vector<FitStage> stages_to_gate(const DesignShape& shape, const TentBins& bins, std::uint64_t max_rays) {
  std::vector<FitStage> stages = ladder(shape, bins, {.rays = max_rays});
  const auto gate = std::find_if(stages.begin(), stages.end(), [](const FitStage& s) { return s.gate; });
  if (gate != stages.end()) stages.erase(gate + 1, stages.end());
  return stages;
}

DesignShape perturbed(const DesignShape& shape, double size_mm, std::uint64_t seed, std::uint64_t stream) {
  Rng rng(seed, stream);
  Eigen::VectorXd parameters = shape.parameters();
  for (double& p : parameters) p += size_mm * (2.0 * rng.uniform() - 1.0);
  return shape.with(parameters);
}

}  // namespace

DesignShape approach(const FitProblem& problem, const DesignShape& given, int attempt,
                     std::uint64_t max_rays) {
  const double size_mm = problem.shake * given.aperture().outer_radius_mm();
  const DesignShape start =
      attempt == 0 ? given
                   : perturbed(given, size_mm, problem.seed, kStream + static_cast<std::uint64_t>(attempt));
  if (std::max(given.intervals_x(), given.intervals_y()) > kApproachIntervals) return start;
  FitProblem coarse = problem;
  coarse.starts.clear();
  if (coarse.flux_weight > 0.0) coarse.flux_weight = kLadderFluxWeight;
  Fit fit(coarse, stages_to_gate(start, problem.bins, max_rays), start);
  const std::uint64_t enough = std::min(kMaxRays, kMaxEvaluations * max_rays);
  while (!fit.done() && fit.state().total_rays < enough) fit.step();
  return fit.best();
}

}  // namespace lucerna
