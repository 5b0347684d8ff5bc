// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/run/design_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "lucerna/design/problem/design_detectors.h"

namespace lucerna {

namespace {

/// Of a target.
PlaneSummary summary_of(const std::vector<double>& values, double factor) {
  double mean = 0.0, min = std::numeric_limits<double>::infinity(), max = 0.0;
  for (const double v : values) {
    mean += factor * v / static_cast<double>(values.size());
    min = std::min(min, factor * v);
    max = std::max(max, factor * v);
  }
  PlaneSummary s{{mean, 0.0}, {min, 0.0}, {max, 0.0}, {}};
  if (mean > 0.0) s.uniformity = Estimate{min / mean, 0.0};
  return s;
}

}  // namespace

DesignMetrics design_metrics(const DesignTarget& target, double error_scale, const TraceResult& traced,
                             const Scene& scene, const Progress& progress) {
  DesignMetrics f;
  f.trace = trace_metrics(traced, scene, {}, progress);
  if (target.zones_only) return f;  // a guide is nothing to compare with
  if (target.mode == TargetMode::shape && error_scale > 0.0) {
    f.target_factor = total_flux(scene.sources) / error_scale;
  }
  if (target.plane) {
    f.target_plane = summary_of(target.plane->map.value, f.target_factor);
    for (const PlaneMetrics& p : f.trace.planes) {
      if (p.image.name == kTargetPlane)
        f.result_plane = PlaneSummary{p.extremes.mean, p.extremes.min, p.extremes.max, p.extremes.uniformity};
    }
    return f;
  }
  IntensityDistribution expected = target.distribution;
  scale(expected, f.target_factor);
  f.target_beam = beam_metrics(expected);
  if (f.trace.far_fields.empty()) return f;
  const FarFieldResult& far = f.trace.far_fields.front();
  const BinnedIntensity& obtained = far.intensity;
  expected.unit = obtained.distribution.unit;  // by shape alone, cd and W/sr may be compared
  CompareOptions options;
  options.test_error_cd = obtained.standard_error_cd;
  if (std::isfinite(far.metrics.flux.standard_error))
    options.test_flux_error = far.metrics.flux.standard_error;
  options.align = false;
  f.comparison = compare_distributions(expected, obtained.distribution, options);
  return f;
}

}  // namespace lucerna
