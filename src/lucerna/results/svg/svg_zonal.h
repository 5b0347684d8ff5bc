// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/results/svg/svg_axes.h"

namespace lucerna {

/// Flux in the eighteen zones of 10 degrees from nadir to zenith as a bar chart (SVG document), each bar with
/// its flux, its share of all and the share from nadir up to its end, by `zonal_flux`. `lamp_flux_lm` has no
/// effect. Throws InputError if the grid breaks its rules. Thread safe; O(values).
std::string zonal_svg(const IntensityDistribution& distribution, const DiagramOptions& options = {});

}  // namespace lucerna
