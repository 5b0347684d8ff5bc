// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <utility>

#include "lucerna/design/lens/lens_design.h"
#include "lucerna/design/run/follow_up.h"

namespace lucerna {

/// A lens with all that follows its design.
struct LensRun : FollowUp {
  explicit LensRun(LensResult found) : result(std::move(found)) {}
  LensResult result;
};

/// What `write_design` needs beside the rest of a DesignedMirror.
struct LensRecord {
  LensProblem problem;
  LensResult result;
  DesignMetrics figures;
  std::uint64_t seed = 1;
};

/// Designs, and traces the result until its figures are good to 1 % (for a tenth of the time, 1 to 10
/// seconds, at most), for which time is kept.
LensRun run_lens(const LensProblem& problem, LensOptions options, Progress& progress = no_progress(),
                 const LensObserver& observer = {});

/// `design` of a project with `free_sides`. Throws InputError for settings that lenses do not have: a
/// checkpoint, `pareto`, `advise`, `tolerances`, a CUDA device.
DesignedMirror designed_lens(Project project, const std::string& name, const DesignSettings& settings,
                             Progress& progress, const DesignWatcher& watcher);

/// Throws InputError for these.
void check_lens_settings(const DesignSettings& settings);

/// What a lens takes of the others.
LensOptions lens_options(const DesignSettings& settings);

}  // namespace lucerna
