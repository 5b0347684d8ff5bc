// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// A Cartesian intensity diagram as an SVG document: intensity over the angle from the beam's axis (nadir, or
/// zenith if more flux goes up), C0 and C90 to the right, C180 and C270 to the left, C0-C180 solid and
/// C90-C270 dashed, with lines at 50 % and 10 % of the peak and the angles they give. The range of angles is
/// the smallest round one that holds all above 1 % (logarithmic 0.1 %) of the peak. `log_scale`: four decades
/// down from the peak. Throws InputError if the grid breaks its rules. Thread safe; O(values).
std::string cartesian_svg(const IntensityDistribution& distribution, const DiagramOptions& options = {},
                          bool log_scale = false);

}  // namespace lucerna
