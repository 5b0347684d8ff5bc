// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lucerna/photometry/metrics/plane_illuminance.h"
#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// What an isolux diagram is drawn for.
struct IsoluxOptions {
  DiagramOptions diagram{};  ///< `lamp_flux_lm` has no effect
  double distance_m = 3.0;   ///< of the plane from the luminaire, square to the axis; above 0
  /// Side of the square shown; none = the smallest of 1, 2, 3, 4, 6, 8, 12 and 16 distances whose border is
  /// under 5 % of the largest illuminance.
  std::optional<double> size_m{};
};

/// An isolux diagram as an SVG document: bands and lines of equal illuminance (lx; W/m2 if radiometric) at
/// round values 1, 2, 5, ... down from the largest, on a square about the axis (nadir, or zenith if more flux
/// goes up), with centre, mean, least, largest, U0 and the diameters at 50 % and 10 %. Seen from above for
/// light that goes down and from below for light that goes up; C0 to the right in both. Throws InputError if
/// the grid breaks its rules or an option is out of range. Thread safe; parallel; O(values + 151^2).
std::string isolux_svg(const IntensityDistribution& distribution, const IsoluxOptions& options = {});

/// The same for any plane, with the plane's own x to the right and y up.
std::string isolux_svg(const PlaneIlluminance& illuminance, FluxUnit unit, const std::string& title,
                       const std::string& below);

}  // namespace lucerna
