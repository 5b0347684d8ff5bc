// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/intensity.h"
#include "lucerna/photometric_file.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Weight of each C plane in the mean over a ring, by the trapezoid rule round the circle: half the gap to
/// the plane before plus half the gap to the plane after, over 360. Sums to 1. Also the width of the C bin
/// centred on the plane.
std::vector<double> plane_weights(std::span<const double> c_deg);

/// Weight of each gamma ring in `total_flux`, in sr: with u = cos gamma, pi (u[g-1] - u[g+1]), at the ends
/// pi (u[0] - u[1]) and pi (u[n-2] - u[n-1]). Sums to the solid angle between the first and the last gamma.
std::vector<double> ring_weights_sr(std::span<const double> gamma_deg);

/// Mean over C of each gamma ring, by `plane_weights`.
std::vector<double> ring_means(const IntensityDistribution& distribution);

/// Flux (lm, or W) as the lighting trade computes it (AGi32's Photometric Toolbox to the printed digit): per
/// band of two neighbouring gammas the mean of the two ring means times 2 pi (cos g1 - cos g2).
double total_flux(const IntensityDistribution& distribution);

/// Flux between two gammas, 0 <= from <= to <= 180, by the same rule: a band that is cut gives the share of
/// its solid angle with the ring mean taken linearly in gamma at the cut. Zones that join add up to
/// `total_flux` where they meet on grid angles, and within the band's curvature elsewhere; the whole sphere
/// always gives `total_flux`.
double zonal_flux(const IntensityDistribution& distribution, double from_deg, double to_deg);

/// The largest value of the grid and where it is (the first in storage order among equals).
struct PeakIntensity {
  double cd = 0.0;                      ///< cd, or W/sr
  double c_deg = 0.0, gamma_deg = 0.0;  ///< where
};
/// The peak of a distribution, which has at least one value.
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
  /// Angle from nadir, and cd (or W/sr) there.
  double angle_deg, cd;
};

/// A part of such a circle, from an angle to a larger one that may be beyond 360.
struct CircleArc {
  /// Ends of the arc, degrees.
  double from_deg = 0.0, to_deg = 360.0;
};

/// The smallest arc of a circle of ascending points, linear between them, that holds all that reaches
/// `threshold`; nothing if no point does, the whole circle if all do.
[[nodiscard]] std::optional<CircleArc> smallest_arc(const std::vector<CirclePoint>& circle, double threshold);

/// Its size.
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

/// The figures that follow a light trace. Angles in degrees; those without a value did not reach their
/// threshold.
struct BeamMetrics {
  double flux = 0.0;  ///< lm, or W
  /// The largest intensity.
  PeakIntensity peak;
  double axis_gamma_deg = 0.0;  ///< the axis of "centre", 0 or 180
  double centre_cd = 0.0;       ///< on the axis
  /// Per pair of planes: C of the pair (< 180), and the four angles.
  struct Plane {
    /// C of the pair, < 180.
    double c_deg = 0.0;
    /// Full angles at 50 % (beam) and 10 % (field) of either reference, degrees.
    std::optional<double> beam_of_maximum, field_of_maximum, beam_of_centre, field_of_centre;
  };
  /// Every pair of planes that is quoted.
  std::vector<Plane> planes;
};

/// All of them, for the pairs C0-C180, C90-C270 and every further grid plane below 180.
[[nodiscard]] BeamMetrics beam_metrics(const IntensityDistribution& distribution);

/// The figures of a data sheet, with the definition of each. Fluxes in lm (or W), angles in degrees.
struct PhotometricMetrics {
  /// Flux, peak, beam and field angles.
  BeamMetrics beam;
  std::optional<double> light_output_ratio;  ///< flux over lamp flux; none for absolute photometry
  std::array<double, 18> zonal{};            ///< flux in zones of 10 degrees from nadir
  /// Flux between two angles from nadir, lm (or W).
  double flux_0_30 = 0.0, flux_0_40 = 0.0, flux_0_60 = 0.0, flux_60_90 = 0.0, flux_0_90 = 0.0,
         flux_90_180 = 0.0;
  /// CIE flux code N1..N5 in percent (CIE 52): flux below 41.4, 60 and 75.5 degrees over that below 90 (cones
  /// of pi/2, pi and 3 pi/2 sr), downward flux over all flux, and light output ratio (100 for absolute
  /// photometry).
  std::array<double, 5> cie_flux_code{};
  /// Smallest gamma beyond which no intensity reaches 2.5 % of the peak, about the beam's axis.
  double cut_off_deg = 0.0;
  /// NEMA type by field angle (10 % of maximum) in the planes C90 (horizontal) and C0 (vertical), as
  /// floodlights are read here (H = type B, C90-C270): 1 10-18, 2 -29, 3 -46, 4 -70, 5 -100, 6 -130, 7 above;
  /// 0 below 10 degrees or no field.
  int nema_horizontal = 0, nema_vertical = 0;
};

/// Computes all of them. Throws InputError if the grid breaks its rules. Thread safe; O(values).
[[nodiscard]] PhotometricMetrics photometric_metrics(const PhotometricFile& file);

/// NEMA type of a field angle: 0 to 7.
int nema_type(std::optional<double> field_angle_deg);

}  // namespace lucerna
#pragma GCC visibility pop
