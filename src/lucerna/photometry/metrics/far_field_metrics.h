// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lucerna/far_field_metrics.h"
#include "lucerna/photometry/binning/counted_sphere.h"
#include "lucerna/photometry/metrics/point_intensity.h"

namespace lucerna {

/// Estimates all of them (FarFieldMetrics). `planes_deg`: the planes below 180 that have beam angles (0 and
/// 90 are added). Where `exact` is known, the axis comes from it, and the peak of a
/// lobe of at most 10 degrees to half of it. About 0.3 s for 36 planes, and as much
/// for `exact`.
FarFieldMetrics far_field_metrics(const CountedSphere& sphere, std::span<const double> planes_deg,
                                  const PointIntensity& exact = {});

}  // namespace lucerna
