// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/photometry/metrics/point_intensity.h"
#include "lucerna/scene.h"
#include "lucerna/trace/metrics/stop_check.h"
#include "lucerna/trace/result/far_field_counts.h"

namespace lucerna {

/// Light that is reflected more often than this on average is found backward by chance only, and slowly.
inline constexpr double kMaxBackwardReflections = 3.0;

/// Intensity in single directions of a scene by light that is followed backward. Empty where that cannot be
/// done (`no_backward_reason`), or where it does not find the light that was counted towards the brightest
/// angle of `field` or the axis (light by many reflections is found by chance). `run_seed` makes runs
/// independent. The scene and `stop`, which each call asks, must outlive it.
PointIntensity backward_intensity(const Scene& scene, int max_bounces, std::uint64_t run_seed,
                                  const CountedFarField& field, const StopCheck& stop);

}  // namespace lucerna
