// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
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

/// What a beam is quoted by, each as FarFieldMetrics has it.
struct PeakAndBeam {
  std::optional<PeakEstimate> peak;
  Estimate axis_cd;
  /// FarFieldMetrics::Plane::beam_of_maximum of C0 and C90.
  std::optional<Estimate> beam_c0_deg, beam_c90_deg;
};

/// These alone, to the same numbers: with `exact` in half the time.
PeakAndBeam peak_and_beam(const CountedSphere& sphere, const PointIntensity& exact = {});

}  // namespace lucerna
