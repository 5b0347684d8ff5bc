// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/far_field_metrics.h"
#include "lucerna/photometry/binning/counted_sphere.h"

namespace lucerna {

/// A peak with `cd.mean` and what it is without each replicate.
struct FoundPeak : PeakEstimate {
  Jackknife values;
  /// Noise of the widest kernel, which is wide for the lobe: what a trace can be asked to bring down.
  double noise_cd = 0.0;
  /// Directions at least `bright_spacing_deg` apart that are nearly as bright, this one first. On the top of
  /// a wide lobe they are what narrower kernels show: it can have ripples, and the highest may be any of
  /// them.
  std::vector<Direction> bright;
  double bright_spacing_deg = 0.0;
};

/// How far a peak is looked for.
enum class PeakSearch {
  brightest_lobe,     ///< of the lobe that a wide kernel sees
  all_scales,         ///< also lobes that are narrow beside it, and edges
  bright_directions,  ///< that, and `bright`
};

/// Finds it. The widest kernel follows from the lobe's own width: from wide to narrow, until the radius is
/// three tenths of the half width of the lobe that is the brightest at that radius. There a quadratic is
/// fitted about all directions that may be the brightest; with that kernel it is too low by 2e-4 for a
/// Gaussian lobe and by 3 % and more for a sharp tip. That the largest of many noisy values is too large is
/// taken off as `largest` does. Except for `brightest_lobe` kernels of half that radius, a quarter, ... look
/// everywhere too; the narrowest is taken of which the peak, at the place that other replicates choose, is
/// higher by three errors of the difference. At the place found narrower kernels follow, each of half the
/// radius; the one of least error is taken, and its error has the bias that the others show
/// (radius_choice.h). Nothing for a dark sphere. About 0.1 s; with narrower kernels up
/// to a second.
std::optional<FoundPeak> peak_estimate(const CountedSphere& sphere,
                                       PeakSearch search = PeakSearch::brightest_lobe);

}  // namespace lucerna
