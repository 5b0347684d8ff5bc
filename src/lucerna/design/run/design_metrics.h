// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/design/run/design.h"
#include "lucerna/intensity_comparison.h"
#include "lucerna/photometric_metrics.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {

/// Illuminance figures of a rectangle; a target's are exact, without errors.
struct PlaneSummary {
  Estimate mean, min, max;
  /// minimum over mean; absent in the dark.
  std::optional<Estimate> uniformity;
};

/// All figures of a finished design, worked out once for text, JSON and files.
struct DesignMetrics {
  /// Of the trace of the finished project.
  TraceMetrics trace;
  /// What the target was multiplied by to stand beside the result: 1 in absolute mode; in shape mode what
  /// makes them differ least.
  double target_factor = 1.0;
  /// Target (multiplied) against the traced far field; for far-field targets.
  std::optional<BeamMetrics> target_beam;
  std::optional<DistributionComparison> comparison;
  /// For plane targets: on their rectangle, wanted (multiplied) and traced.
  std::optional<PlaneSummary> target_plane, result_plane;
  std::optional<ToleranceSweep> tolerances;
};

/// `traced` is a trace of `scene`, the finished project's; `scale` is DesignError::scale of the result. About
/// two seconds for a far-field target, less once `progress` asks to stop (trace_metrics).
DesignMetrics design_metrics(const DesignTarget& target, double scale, const TraceResult& traced,
                             const Scene& scene, const Progress& progress = no_progress());

}  // namespace lucerna
