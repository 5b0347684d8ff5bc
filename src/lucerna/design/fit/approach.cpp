// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/approach.h"

#include <algorithm>

#include "lucerna/core/io/error.h"
#include "lucerna/design/fit/fit.h"
#include "lucerna/design/shape/perturbed.h"

namespace lucerna {

namespace {

/// Rays of all evaluations, at most; and how many evaluations of the most rays.
constexpr std::uint64_t kMaxApproachRays = std::uint64_t{1} << 23, kMaxEvaluations = 64;
/// Random streams of perturbed starts begin here.
constexpr std::uint64_t kStream = std::uint64_t{1} << 34;

}  // namespace

bool has_few_knots(const DesignShape& shape) {
  return std::max(shape.intervals_x(), shape.intervals_y()) <= kApproachIntervals;
}

Approached approach(const FitProblem& problem, const DesignShape& given, int restart,
                    std::uint64_t max_rays) {
  LUCERNA_CHECK(has_few_knots(given), "{} x {} intervals", given.intervals_x(), given.intervals_y());
  DesignShape start = given;
  if (restart != 0) {
    start = perturbed(given, problem.perturbation * given.radius_mm(),
                      Rng(problem.seed, kStream + static_cast<std::uint64_t>(restart)));
  }
  FitProblem coarse = problem;
  coarse.guesses.clear();
  if (coarse.flux_weight > 0.0) coarse.flux_weight = kFitFluxWeight;
  const ContinuationSchedule schedule =
      continuation_schedule(start, problem.bins, {.rays = max_rays}).up_to_screening();
  Fit fit(coarse, schedule, start);
  const std::uint64_t enough = std::min(kMaxApproachRays, kMaxEvaluations * max_rays);
  while (!fit.done() && fit.state().total_rays < enough) fit.step();
  // The cap on rays may end the fit before it has come to the mirror's own knots.
  return {fit.best().refined(given.intervals_x(), given.intervals_y()), fit.state().evaluations,
          fit.state().total_rays};
}

}  // namespace lucerna
