// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// What a cone diagram is drawn for.
struct ConeOptions {
  DiagramOptions diagram{};      ///< `lamp_flux_lm` has no effect
  double fraction = 0.5;         ///< the cone's edge: this share of the largest intensity; in (0, 1]
  double last_distance_m = 5.0;  ///< of five even steps; above 0
};

/// A cone diagram as an SVG document: the edges of the beam in the planes C0-C180 (left) and C90-C270 (right)
/// and, on planes square to the axis (nadir, or zenith if more flux goes up) at five distances, the widths
/// between those edges, the illuminance on the axis and the largest on the plane (W/m2 if radiometric). Edges
/// are the outermost directions within 80 degrees of the axis with at least `fraction` of the largest
/// intensity there; a side of a beam that is wider is drawn open and its width given as a lower bound, ">".
/// Throws InputError if the grid breaks its rules or an option is out of range. Thread safe; O(values).
std::string cone_svg(const IntensityDistribution& distribution, const ConeOptions& options = {});

}  // namespace lucerna
