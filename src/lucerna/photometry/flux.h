// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/photometry/intensity_distribution.h"

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

}  // namespace lucerna
