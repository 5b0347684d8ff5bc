// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "lucerna/estimate.h"
#include "lucerna/geometry.h"
#include "lucerna/photometric_metrics.h"

namespace lucerna {

/// Intensity in one direction, known without cells and kernels: (direction, samples, seed) to an unbiased
/// estimate whose error falls with `samples`. Thread safe. Empty: not known.
using PointIntensity =
    std::function<Estimate(const Direction& direction, std::uint64_t samples, std::uint64_t seed)>;

/// The intensity to a relative error of 0.15 %, or as near to it as 2^13 samples bring it.
Estimate precise_intensity(const PointIntensity& intensity, const Direction& direction);

/// A local maximum. On a top with ripples the highest may be higher by about `search_error_cd`, which follows
/// from how the heights of those that were found are spread; 0 where all searches end on one.
struct PointPeak {
  Direction direction;
  Estimate cd;
  double search_error_cd = 0.0;
  /// The error of the direction on its ripple, and other tops. These differ by what the search error allows.
  double ripple_error_deg = 0.0;
  std::vector<Direction> others = {};
};

/// The brightest direction by pattern searches, each within about `radius_deg` of where it starts: about the
/// brightest eight of `starts`, then about places up to four radii from the best top. The value is from
/// samples that the searches have not seen. At least one start. Some 300,000 samples.
PointPeak brightest_point(const PointIntensity& intensity, std::span<const Direction> starts,
                          double radius_deg);

/// A line of directions, by angle.
using DirectionAt = std::function<Direction(double angle_deg)>;

/// Where the ends of an arc are looked for: from so far outside of where they seem to be, in such steps.
struct ArcWindow {
  double outward_deg = 0.0, step_deg = 0.0;
  /// The noise of a mean about either end may be this share of the threshold. Where it is larger, few of the
  /// samples carry the light, and their scatter says little of its error.
  double max_noise = std::numeric_limits<double>::infinity();
};

/// The size of an arc on which the intensity is `threshold` or more, and falls below it at both ends. The
/// outermost crossing is looked for inwards to the middle of `near` (kernels widen an arc, or shift it), or
/// as far again outwards where it is still bright; nothing where it is not there, or the noise is above the
/// window's. Where noise leaves open which of several crossings is the outermost, that is in the error. A
/// ripple narrower than a step may be missed. 60 to 150 short estimates.
std::optional<Estimate> exact_arc_deg(const PointIntensity& intensity, const DirectionAt& at,
                                      const CircleArc& near, const ArcWindow& window,
                                      const Estimate& threshold);

}  // namespace lucerna
