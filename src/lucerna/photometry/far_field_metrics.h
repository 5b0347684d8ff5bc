// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/photometry/counted_sphere.h"
#include "lucerna/photometry/peak_estimate.h"

namespace lucerna {

/// What a data sheet quotes of a traced far field, each figure with its standard error (the jackknife's over
/// the replicates; NaN where there are fewer than two). Absent: not determined, because the threshold is not
/// reached or the error is larger than the figure could bear.
struct FarFieldMetrics {
  Estimate flux;
  /// Absent for a dark far field.
  std::optional<PeakEstimate> peak;
  /// The axis of "centre", 0 or 180: where more flux goes.
  double axis_gamma_deg = 0.0;
  /// Intensity on the axis: a quadratic fit within `axis_radius_deg`.
  Estimate axis_cd;
  double axis_radius_deg = 0.0;
  /// A pair of planes C and C + 180.
  struct Plane {
    double c_deg = 0.0;
    std::optional<Estimate> beam_of_maximum, field_of_maximum, beam_of_centre, field_of_centre;
  };
  std::vector<Plane> planes;
  /// Largest angle from the axis at which 2.5 % of the peak are reached in any of `planes`.
  std::optional<Estimate> cut_off_deg;
  /// Flux in zones of 10 degrees from nadir, and in wider ones.
  std::array<Estimate, 18> zonal{};
  Estimate flux_0_30, flux_0_40, flux_0_60, flux_60_90, flux_0_90, flux_90_180;
  /// CIE flux code N1 to N4 in percent (figures.h).
  std::array<Estimate, 4> cie_flux_code{};
  /// Flux in the ten secondary solid angles of TM-15 with the street at C90, in the order of LuminaireZones:
  /// what BUG ratings are made of.
  std::array<Estimate, 10> bug_zones{};
  /// Intensity at gamma 45, 55, 65, 75 and 85 in C0 and then in C90 (within `glare_radius_deg`): what UGR
  /// and luminance limits are made of.
  std::array<Estimate, 10> glare_cd{};
  double glare_radius_deg = 0.0;
};

/// Estimates all of them. `planes_deg`: the planes below 180 that have beam angles (0 and 90 are added).
/// About 0.3 s for 36 planes.
FarFieldMetrics far_field_metrics(const CountedSphere& sphere, std::span<const double> planes_deg);

}  // namespace lucerna
