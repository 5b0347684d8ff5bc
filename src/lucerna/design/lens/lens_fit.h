// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/fit/fit_record.h"
#include "lucerna/design/lens/entry_face.h"
#include "lucerna/design/lens/lens_problem.h"
#include "lucerna/progress.h"

namespace lucerna {

/// How a lens is fitted.
struct LensFitOptions {
  std::uint64_t seed = 1;
  /// Rays of the finest evaluations, at most.
  std::uint64_t max_rays = std::uint64_t{1} << 22;
  /// Cavities that are compared where the entry is free, at most.
  std::size_t cavity_trials = 24;
};

/// What a fit came to.
struct LensFitResult {
  explicit LensFitResult(ShapedLens found) : lens(std::move(found)) {}
  ShapedLens lens;
  /// The cavity that the entry has become, if it has; nothing where it is the given one or a free form.
  std::optional<Cavity> cavity;
  std::vector<FitRecord> history;
  DesignTermination end = DesignTermination::converged;
  bool at_noise = false;
  int evaluations = 0;
  std::uint64_t rays = 0;
};

/// Called after each step, with the best so far; false ends the fit.
using LensFitWatcher = std::function<bool(const FitRecord& step, const ShapedLens& best)>;

/// Shapes the lens by Levenberg-Marquardt on stages from coarse bins and few rays to fine ones and many
/// (docs/theory/lens-design.md). The given lens, the zero-étendue ones and smoothly perturbed copies go
/// through the coarse stages until one is at the noise, the best of them on. Then the best is perturbed,
/// until only noise is left or `max_failed_restarts` of these in a row gained nothing. Decisions depend on
/// counts alone. `rays`: in the lens's frame; grows.
LensFitResult fit_lens(const LensProblem& problem, const LensFitOptions& options, DesignRays& rays,
                       const LensFitWatcher& watch);

}  // namespace lucerna
