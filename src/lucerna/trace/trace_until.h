// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string_view>

#include "lucerna/trace/trace.h"

namespace lucerna {

/// When `trace_until` has enough.
struct NoiseGoal {
  /// What `node_noise` shall be at most, and `peak_noise` half of it: a peak that is quoted shall be within
  /// it.
  double noise = 0.01;
  /// Seconds after which it stops with what it has; at least one round is traced.
  double most_seconds = 60.0;
  /// Rays after which it stops; at most kMostRays.
  std::uint64_t most_rays = kMostRays;
};

/// Why it stopped.
enum class NoiseEnd {
  reached,        ///< the noise is what was asked for
  time,           ///< NoiseGoal::most_seconds
  rays,           ///< NoiseGoal::most_rays
  finite_source,  ///< a ray file has given all its rays: more would be the same ones again
  no_goal,        ///< no far field to measure noise in, or kept rays that would fill the memory
};
/// One sentence for people; empty for `reached`.
std::string_view to_string(NoiseEnd end);

struct NoiseTrace {
  TraceResult result;
  /// node_noise of the result; NaN where it is not known.
  double noise = 0.0;
  NoiseEnd end = NoiseEnd::reached;
};

/// Traces until the far fields are as good as asked for. The number of rays grows in fixed rounds (2^20 times
/// 1, 1.5, 2, 3, 4, 6, ...), and the noise after a round decides: with the same scene, seed and goal the
/// result is the same to the bit for any number of threads, unless the time stops it, and a run that is gone
/// on with (`from`) is the run that was never stopped. Finite sources are traced once; scenes without a far
/// field, and those that keep rays, are traced as `trace` does by default. `options.last_ray` is ignored, and
/// with `from` so is `first_ray`, `seed` and `sequence`. Throws as `trace`; what Interrupted stops is lost.
NoiseTrace trace_until(const Scene& scene, const TraceOptions& options, const NoiseGoal& goal,
                       std::optional<TraceResult> from = std::nullopt, Progress& progress = no_progress());

}  // namespace lucerna
