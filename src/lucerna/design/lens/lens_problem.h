// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/lens/lens_limits.h"
#include "lucerna/design/problem/target.h"
#include "lucerna/project.h"
#include "lucerna/trace/kernels/solid_kernel.h"

namespace lucerna {

/// A lens that is to be designed, checked.
struct LensProblem {
  Project project;
  DesignTarget target;
  LensLimits limits;
  /// The lens to begin with: the project's solid.
  LensShape start;
  MediumView medium;
  Frame world_from_lens;
  double time_s = 60.0;
  int max_failed_restarts = 1'000'000;
};

/// Whether a project asks for a lens: [design] has `free_sides`.
bool is_lens_design(const Project& project);

/// Reads [target] and [design] of a project with one solid, given by its outline, and nothing else in the
/// light's way. Throws InputError with file, line, key, found and expected. The project gets the
/// detectors of every design (add_design_detectors).
LensProblem lens_problem(Project project, const std::filesystem::path& path);

/// The bins of the last stages: rings half as wide as the boxes of the error where the target turns about the
/// lens's axis, else 48 x 48.
TentBins lens_window(const LensProblem& problem);

/// The project's solid with another outline.
Solid with_outline(const LensProblem& problem, const LensShape& shape);
/// The project with that solid: what `trace` takes.
Project with_lens(const LensProblem& problem, const LensShape& shape);

}  // namespace lucerna
