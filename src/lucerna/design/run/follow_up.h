// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>

#include "lucerna/design/fit/fit_record.h"
#include "lucerna/design/run/design_metrics.h"
#include "lucerna/trace.h"

namespace lucerna {

/// What follows a design, of a mirror or a lens.
struct FollowUp {
  /// Light of the project with the result.
  NoiseTrace trace;
  /// Noise that `trace` was to have.
  double noise_goal = 0.0;
  DesignMetrics figures;
  /// Seconds of each phase.
  double design_s = 0.0, trace_s = 0.0, figures_s = 0.0, tolerances_s = 0.0;
};

/// The goal of the trace that follows a design of `time_s`: figures good to 1 %, for a tenth of the time, 1
/// to 10 seconds, at most.
NoiseGoal final_goal(double time_s);

/// Traces the finished scene, by `trace` unless it is empty, and works out its figures. `error_scale`:
/// DesignError::scale of the result.
void follow_up(const DesignTarget& target, double error_scale, const Scene& finished,
               const TraceOptions& options, const NoiseGoal& goal, const FinalTrace& trace,
               const Progress& progress, FollowUp& out);

/// What users of the library get of a step.
DesignStep design_step(const FitRecord& record);

/// What `work` returns; `seconds` gets how long it took.
template <class Work>
auto timed(double& seconds, const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  auto made = work();
  seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return made;
}

}  // namespace lucerna
