// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "lucerna/far_field_metrics.h"
#include "lucerna/intensity.h"
#include "lucerna/photometry/binning/jackknife.h"

namespace lucerna {

/// The cells into which traced flux is counted: one per grid angle, centred on it, with edges half way to its
/// neighbours. The cells of the first and last gamma are half cells; at gamma 0 and 180 they are wedges of a
/// polar cap.
struct IntensityBins {
  /// Lower edge of C bin i; bin i is [c_edge_deg[i], c_edge_deg[i + 1]), the last one ends at c_edge_deg[0] +
  /// 360. c_edge_deg[0] is negative (half the last gap) unless there is one plane only ([0, 360)).
  std::vector<double> c_edge_deg;
  /// gamma_edge_deg[g], gamma_edge_deg[g + 1] bound bin g; one more than there are gammas.
  std::vector<double> gamma_edge_deg;
  /// Solid angle of bin [c][g] in sr: `solid_angle_sr[c * gammas + g]`.
  std::vector<double> solid_angle_sr;
};

/// The bins of a grid (planes ascending from 0 below 360, gammas ascending within [0, 180]; InputError
/// otherwise).
IntensityBins intensity_bins(std::span<const double> c_deg, std::span<const double> gamma_deg);

/// The integral over each tent in gamma of sin gamma: from the neighbour before to the neighbour after. The
/// gammas must reach from 0 to 180.
std::vector<double> tent_integrals(std::span<const double> gamma_deg);

/// Intensities from flux per bin ([c][gamma], as `intensity_bins` cuts the sphere), such that `total_flux` of
/// the result is the sum of the bins to rounding.
///
/// Pooling. Cells shrink with sin gamma towards the poles, their noise grows; but nothing there is finer than
/// the gamma step. So a value is the mean over an arc of its ring that is as long as the ring is high, where
/// a plane's own bin is shorter (within 11.5 degrees of the poles on a grid of 5 x 1 degrees); at a pole it
/// is the mean of all wedges. The solid angle behind a value never falls below three quarters of a square of
/// the gamma step, and the flux of a ring stays its own.
///
/// Closing. A bin's flux over its solid angle is the mean intensity A of the cell. `total_flux` weights ring
/// k with W_k, the cell ring has the solid angle S_k; on equal steps d, W_k = cos(d/2) S_k inside but W_0 = 2
/// cos^2(d/4) S_0 at a pole, so cell means put into that sum count the polar caps twice. Dividing by W_k
/// instead would close the sum but halve the intensity on the axis. For a smooth beam the ring values that
/// return its flux without touching the axis are R = I - (d^2/12) (I'' - I' cot gamma); with A = I + (d^2/24)
/// I'' + (d^2/12) I' cot gamma this is R = A - (d^2/8) I'', and at the pole R = A - (A_1 - A_0) / 9. So each
/// ring is multiplied by R/A of its ring mean, with I'' from the second difference of the ring means, limited
/// by the smaller of the two first differences (minmod), which leaves sharp edges and noise alone and values
/// non-negative. What is then left to the exact flux (fourth order in d / beam width) is one factor on all
/// values, returned as `closure`. A ring factor is a mean over all planes, so a value's relative noise stays
/// that of its ray count.
///
/// Errors. `replicated` (the same flux, and without each replicate; empty = errors unknown) goes the same
/// way; the jackknife's variances, known to 37 % each from 16 replicates, are then pooled as node_errors.h
/// says.
///
/// `flux` must be finite and >= 0, of size planes * gammas; `replicated` of the same size or empty. Throws
/// InputError otherwise. O(bins).
BinnedIntensity intensity_from_bins(std::span<const double> c_deg, std::span<const double> gamma_deg,
                                    std::span<const double> flux, const JackknifedFlux& replicated = {},
                                    FluxUnit unit = FluxUnit::lumen);

/// Intensities from flux that was dealt to the grid's angles by tents (each ray to its two neighbours in C
/// and in gamma, in proportion to nearness): flux over the integral of the tent, the weighted mean of the
/// intensity about the angle, pooled about the poles as above; one factor on all values (`closure`) makes
/// `total_flux` exact. The grid must reach from 0 to 180. Errors and cost as `intensity_from_bins`;
/// neighbours' errors are correlated.
BinnedIntensity intensity_from_tents(std::span<const double> c_deg, std::span<const double> gamma_deg,
                                     std::span<const double> flux, const JackknifedFlux& replicated = {},
                                     FluxUnit unit = FluxUnit::lumen);

}  // namespace lucerna
