// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "lucerna/estimate.h"
#include "lucerna/intensity.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// The largest intensity and where it is, from counted flux.
struct PeakEstimate {
  /// The largest intensity, cd (W/sr for radiometric light).
  Estimate cd;
  /// The brightest direction found, also where it is not determined.
  Direction direction;
  /// Its Type C angles; absent where they are not determined: other directions (two equal lobes, a ring, a
  /// flat top) are as bright within the error. C is absent too where the direction is the axis within its
  /// error.
  std::optional<Estimate> c_deg, gamma_deg;
  /// Standard error of the direction as an angle; NaN where it is not known.
  double direction_error_deg = 0.0;
  /// Half width of the lobe at half its peak, to its nearest side that falls that far and on the average of
  /// the two sides in the narrowest section; at most 180.
  double half_width_deg = 0.0, nearest_side_deg = 0.0;
  /// Radii of the kernel of the fit, along gamma and along C; 0 where the intensity is that of the direction
  /// alone.
  double radius_deg = 0.0, c_radius_deg = 0.0;
};

/// What a data sheet quotes of a traced far field, each figure with its standard error (the jackknife's over
/// the replicates; NaN where there are fewer than two). Absent: not determined, because the threshold is not
/// reached or the error is larger than the figure could bear.
struct FarFieldMetrics {
  /// All light, lm (or W).
  Estimate flux;
  /// Absent for a dark far field.
  std::optional<PeakEstimate> peak;
  /// The axis of "centre", 0 or 180: where more flux goes.
  double axis_gamma_deg = 0.0;
  /// Intensity on the axis.
  Estimate axis_cd;
  /// Radius of the fit about the axis; 0 where the intensity is that of the direction alone.
  double axis_radius_deg = 0.0;
  /// A pair of planes C and C + 180.
  struct Plane {
    /// C of the pair, < 180.
    double c_deg = 0.0;
    /// Full angles at 50 % (beam) and 10 % (field) of either reference, degrees.
    std::optional<Estimate> beam_of_maximum, field_of_maximum, beam_of_centre, field_of_centre;
  };
  /// Every pair of planes that is quoted.
  std::vector<Plane> planes;
  /// Largest angle from the axis at which 2.5 % of the peak are reached in any of `planes`.
  std::optional<Estimate> cut_off_deg;
  /// Flux in zones of 10 degrees from nadir, and in wider ones.
  std::array<Estimate, 18> zonal{};
  /// Flux between two angles from nadir.
  Estimate flux_0_30, flux_0_40, flux_0_60, flux_60_90, flux_0_90, flux_90_180;
  /// CIE flux code N1 to N4 in percent.
  std::array<Estimate, 4> cie_flux_code{};
  /// Flux in the ten secondary solid angles of TM-15 with the street at C90, in the order of LuminaireZones:
  /// what BUG ratings are made of.
  std::array<Estimate, 10> bug_zones{};
  /// Intensity at gamma 45, 55, 65, 75 and 85 in C0 and then in C90 (within `glare_radius_deg`): what UGR
  /// and luminance limits are made of.
  std::array<Estimate, 10> glare_cd{};
  /// Radius of the fits about these directions.
  double glare_radius_deg = 0.0;
};

/// Intensities estimated from counted flux.
struct BinnedIntensity {
  /// The estimates.
  IntensityDistribution distribution;
  /// Standard error of each value of `distribution.cd`; empty if it is not known.
  std::vector<double> standard_error_cd;
  /// The last factor on all values that made the flux exact. 1 within a percent on a grid that resolves the
  /// beam; further away means that the gamma step is too wide for what was traced, and the values are
  /// uncertain by as much.
  double closure = 1.0;
};

}  // namespace lucerna
#pragma GCC visibility pop
