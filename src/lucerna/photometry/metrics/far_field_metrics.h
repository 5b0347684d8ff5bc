// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lucerna/far_field_metrics.h"
#include "lucerna/photometry/binning/counted_sphere.h"
#include "lucerna/photometry/metrics/point_intensity.h"

namespace lucerna {

/// Estimates all of them (FarFieldMetrics). `planes_deg`: the planes below 180 that have beam angles (0 and
/// 90 are added). Where `exact` is known, peak and axis come from it, and the ends of beam and field angles
/// in planes that are multiples of 45 degrees, where it knows the light about them well. About 0.3 s for 36
/// planes, and some seconds for `exact`.
FarFieldMetrics far_field_metrics(const CountedSphere& sphere, std::span<const double> planes_deg,
                                  const PointIntensity& exact = {});

}  // namespace lucerna
