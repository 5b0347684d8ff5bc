// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "lucerna/design/run/design_metrics.h"
#include "lucerna/trace.h"

namespace lucerna {

/// A design with all that follows it.
struct DesignRun {
  DesignResult result;
  /// Light of the project with the result's mirror.
  NoiseTrace trace;
  /// Noise that `trace` was to have.
  double noise_goal = 0.0;
  /// With tolerances where the problem has ranges, unless the design was interrupted.
  DesignMetrics figures;
  /// Seconds of each phase.
  double design_s = 0.0, trace_s = 0.0, figures_s = 0.0, tolerances_s = 0.0;
};

/// What `write_design` needs beside the rest of a DesignedMirror.
struct DesignRecord {
  DesignProblem problem;
  DesignResult result;
  DesignMetrics figures;
  std::uint64_t seed = 1;
  /// "cpu", or the name of the device that evaluated.
  std::string device;
};

/// Designs, traces the result until its figures are good to 1 % (for a tenth of the time, 1 to 10 seconds, at
/// most), and tries the tolerances. Time is kept for these; `options.rays_after` is not read. Throws as
/// `design`.
DesignRun run_design(const DesignProblem& problem, DesignOptions options, Progress& progress = no_progress(),
                     const DesignObserver& observer = {});

/// Where evaluations are traced: the first CUDA device, or null for the CPU. Throws InputError where `cuda`
/// is asked for and there is none.
std::shared_ptr<Accelerator> design_accelerator(TraceDevice device);

}  // namespace lucerna
