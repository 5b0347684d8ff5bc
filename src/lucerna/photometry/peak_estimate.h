// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/photometry/counted_sphere.h"

namespace lucerna {

/// The largest intensity and where it is, from counted flux.
struct PeakEstimate {
  Estimate cd;
  /// `cd.mean` and what it is without each replicate.
  Jackknife values;
  /// The brightest direction found, also where it is not determined.
  Direction direction;
  /// Its Type C angles; absent where they are not determined: other directions (two equal lobes, a ring, a
  /// flat top) are as bright within the error. C is absent too where the direction is the axis within its
  /// error.
  std::optional<Estimate> c_deg, gamma_deg;
  /// Standard error of the direction as an angle; NaN where it is not known.
  double direction_error_deg = 0.0;
  /// Half width of the lobe at half its peak, to its nearest side that falls that far and on the average of
  /// the two sides in the narrowest section; at most 180.
  double half_width_deg = 0.0, nearest_side_deg = 0.0;
  /// Radii of the kernel of the fit, along gamma and along C.
  double radius_deg = 0.0, c_radius_deg = 0.0;
};

/// Finds it. Which radius a lobe is looked at with follows from its own width, not from the noise, so that
/// runs of any length estimate the same thing: from wide to narrow, until the kernel's radius is three tenths
/// of the half width of the lobe that is the brightest at that radius. There a quadratic is fitted about all
/// directions that may be the brightest; with that kernel it is too low by 2e-4 for a Gaussian lobe and by 3
/// % for a cone's tip. That the largest of many noisy values is too large is taken off as `largest` does.
/// Nothing for a dark sphere. About 0.1 s.
std::optional<PeakEstimate> peak_estimate(const CountedSphere& sphere);

}  // namespace lucerna
