// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/design/lens/lens_fit.h"
#include "lucerna/design/lens/lens_problem.h"

namespace lucerna {

struct LensOptions {
  std::uint64_t seed = 1;
  /// Wall time; nothing: the problem's own. It only stops: every decision depends on counts.
  std::optional<double> time_s;
  std::uint64_t max_rays = std::uint64_t{1} << 22;
  /// Rays of the validation, at most.
  std::uint64_t validation_rays = std::uint64_t{1} << 23;
};

struct LensResult : DesignFindings {
  explicit LensResult(ShapedLens found) : lens(std::move(found)) {}
  ShapedLens lens;
  std::vector<FitRecord> history;
  double validation_s = 0.0;
};

/// Called after every step with the best so far.
using LensObserver = std::function<void(const FitRecord& step, const ShapedLens& best)>;

/// Shapes the problem's lens until its light is the target's, validates it by fresh rays through its mesh,
/// and keeps the given lens where that is the better one. Progress phases "rays", "validate". Stops when
/// progress asks to, with the best so far.
LensResult design_lens(const LensProblem& problem, const LensOptions& options,
                       Progress& progress = no_progress(), const LensObserver& observer = {});

}  // namespace lucerna
