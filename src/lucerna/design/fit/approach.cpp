// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/fit/approach.h"

#include <algorithm>

#include "lucerna/core/io/error.h"
#include "lucerna/design/fit/fit.h"

namespace lucerna {

namespace {

/// Rays of all evaluations, at most; and how many evaluations of the most rays.
constexpr std::uint64_t kMaxApproachRays = std::uint64_t{1} << 23, kMaxEvaluations = 64;

}  // namespace

bool has_few_knots(const DesignShape& shape) {
  return std::max(shape.intervals_x(), shape.intervals_y()) <= kApproachIntervals;
}

FitProblem with_fit_flux_weight(FitProblem problem) {
  if (problem.flux_weight > 0.0) problem.flux_weight = kFitFluxWeight;
  return problem;
}

FoundShape approach(const FitProblem& problem, const InitialGuess& start, std::uint64_t max_rays) {
  const int nx = start.shape.intervals_x(), ny = start.shape.intervals_y();
  LUCERNA_CHECK(has_few_knots(start.shape), "{} x {} intervals", nx, ny);
  FitProblem coarse = with_fit_flux_weight(problem);
  coarse.guesses = {start};
  const ContinuationSchedule schedule =
      continuation_schedule(start.shape, problem.bins, {.rays = max_rays}).up_to_screening();
  Fit fit(coarse, schedule, start.shape);
  const std::uint64_t enough = std::min(kMaxApproachRays, kMaxEvaluations * max_rays);
  while (!fit.done() && fit.state().total_rays < enough) fit.step();
  // The cap on rays may end the fit before it has come to the mirror's own knots.
  return {fit.best().refined(nx, ny), fit.state().evaluations, fit.state().total_rays};
}

}  // namespace lucerna
