// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "lucerna/photometry/intensity_distribution.h"

namespace lucerna {

/// The largest value of the grid and where it is (the first in storage order among equals).
struct PeakIntensity {
  double cd = 0.0;
  double c_deg = 0.0, gamma_deg = 0.0;
};
PeakIntensity peak_intensity(const IntensityDistribution& distribution);

/// Which intensity the 50 % and 10 % of a beam or field angle refer to. They differ on batwings.
enum class BeamReference {
  maximum,  ///< the largest of the whole distribution (IES)
  centre,   ///< on the axis (CIE, IEC TR 61341)
};

/// The axis that "centre" means: nadir, or zenith if more flux goes up than down.
double axis_gamma_deg(const IntensityDistribution& distribution);

/// One point of the great circle through the planes C and C + 180: angle from nadir (positive in C, 0 to
/// 360) and intensity.
struct CirclePoint {
  double angle_deg, cd;
};

/// The smallest arc of a circle of ascending points, linear between them, that holds all that reaches
/// `threshold`; nothing if no point does, 360 if all do.
std::optional<double> smallest_arc_deg(const std::vector<CirclePoint>& circle, double threshold);

/// Largest angle from nadir (from zenith if `up`) at which such a circle reaches `threshold`, 0 to 180.
std::optional<double> farthest_from_axis_deg(const std::vector<CirclePoint>& circle, double threshold,
                                             bool up);

/// Full angle in degrees, in the great circle of the planes C and C + 180, of the smallest arc that holds
/// every direction with at least `fraction` of the reference intensity; crossings are linear between grid
/// angles. Counts the outermost crossings, also of a beam off the axis. Nothing if the reference is zero or
/// no direction of the circle reaches it. 360 if all of the circle does. O(gammas).
std::optional<double> beam_angle_deg(const IntensityDistribution& distribution, double c_deg, double fraction,
                                     BeamReference reference);

/// Mean intensity over the cone of half angle `half_angle_deg` about a direction, by solid angle: the centre
/// beam intensity that does not hang on one noisy bin. 0.001 <= half angle <= 90. Midpoint rule on 32 rings
/// of 64 points, equal solid angles.
double cone_mean_cd(const IntensityDistribution& distribution, const Direction& axis, double half_angle_deg);

/// Standard error of `cone_mean_cd` from independent standard errors of the grid values (same layout as
/// `cd`).
double cone_mean_error_cd(const IntensityDistribution& distribution,
                          std::span<const double> standard_error_cd, const Direction& axis,
                          double half_angle_deg);

/// The figures that follow a light trace. Angles in degrees; those without a value did not reach their
/// threshold.
struct BeamFigures {
  double flux = 0.0;  ///< lm, or W
  PeakIntensity peak;
  double axis_gamma_deg = 0.0;  ///< the axis of "centre", 0 or 180
  double centre_cd = 0.0;       ///< mean over the cone of `centre_cone_deg` half angle about the axis
  double centre_cone_deg = 0.0;
  /// Per pair of planes: C of the pair (< 180), and the four angles.
  struct Plane {
    double c_deg = 0.0;
    std::optional<double> beam_of_maximum, field_of_maximum, beam_of_centre, field_of_centre;
  };
  std::vector<Plane> planes;
};

/// All of them, for the pairs C0-C180, C90-C270 and every further grid plane below 180. `centre_cone_deg` is
/// the half angle for the centre intensity; the default is small against any beam and holds many bins of a 1
/// degree grid.
BeamFigures beam_figures(const IntensityDistribution& distribution, double centre_cone_deg = 1.0);

}  // namespace lucerna
