// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// An isocandela diagram as an SVG document: lines of equal intensity, at the shares `kPeakShares` of the
/// largest one shown, over the angles H and V of a type B goniometer about the beam's axis (nadir, or zenith
/// if more flux goes up), seen from the luminaire along the beam: V up is C0, H right is C270 for light that
/// goes down and C90 for light that goes up. sin H = sin(angle from the axis) x sin(C against V's plane), tan
/// V = tan(angle) x cos(C); so it shows the hemisphere about the axis, and of it the smallest round range
/// that holds all above 1 % of the peak. 50 % and 10 % (beam and field) are drawn heavier. Throws InputError
/// if the grid breaks its rules. Thread safe; O(values + 181^2).
std::string isocandela_svg(const IntensityDistribution& distribution, const DiagramOptions& options = {});

/// A false-colour map of all directions as an SVG document: two discs of equal area per solid angle (Lambert
/// 1772), the lower hemisphere about nadir and the upper about zenith, both with C0 to the right and C90 up,
/// as seen from above; bands at `kPeakShares` of the peak. Throws as above. Thread safe; O(values + 2 x
/// 181^2).
std::string sphere_svg(const IntensityDistribution& distribution, const DiagramOptions& options = {});

}  // namespace lucerna
