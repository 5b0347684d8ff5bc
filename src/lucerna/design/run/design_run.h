// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <utility>

#include "lucerna/design/run/follow_up.h"

namespace lucerna {

/// A design with all that follows it: figures with tolerances where the problem has ranges, unless the design
/// was interrupted.
struct DesignRun : FollowUp {
  explicit DesignRun(DesignResult found) : result(std::move(found)) {}
  DesignResult result;
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
