// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/follow_up.h"

#include <algorithm>

namespace lucerna {

NoiseGoal final_goal(double time_s) {
  constexpr double kShare = 0.1;
  NoiseGoal goal;
  goal.max_seconds = std::clamp(kShare * time_s, 1.0, 10.0);
  return goal;
}

void follow_up(const DesignTarget& target, double error_scale, const Scene& finished,
               const TraceOptions& options, const NoiseGoal& goal, const FinalTrace& trace,
               const Progress& progress, FollowUp& out) {
  out.noise_goal = goal.noise;
  std::optional<NoiseTrace> traced = timed(out.trace_s, [&] {
    return trace ? trace(finished, options, goal) : trace_until(finished, options, goal);
  });
  if (!traced) return;
  out.trace = std::move(*traced);
  out.figures = timed(out.figures_s, [&] {
    return design_metrics(target, error_scale, out.trace.result, finished, progress);
  });
}

DesignStep design_step(const FitRecord& r) {
  return {r.evaluations, r.total_rays, r.error, r.floor, r.efficiency, r.in_rectangle, r.accepted};
}

}  // namespace lucerna
