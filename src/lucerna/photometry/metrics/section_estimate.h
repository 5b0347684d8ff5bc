// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/binning/counted_sphere.h"

namespace lucerna {

/// Crossings of one section of counted flux, the great circle of the planes C and C + 180. Kernel means along
/// it are made once a radius and kept.
class Section {
 public:
  /// Radii from the cells' own up to `widest_deg` are tried. Below `dark_cd` values need no errors. The
  /// sphere must outlive it.
  Section(const CountedSphere& sphere, double c_deg, double widest_deg, double dark_cd);

  /// Full angle of the smallest arc that holds every direction with at least `threshold` (its values without
  /// each replicate go with the section's), as `beam_angle_deg` has it. The section is smoothed with the
  /// smallest kernel for which the angle's error is small (a tenth of a degree or 0.5 %), or with the one of
  /// least error; where a smaller kernel sees another angle, that is part of the error. Nothing where the
  /// threshold is not reached, or the angle is not determined: its error is above a degree and a tenth of it,
  /// or some draw of the noise leaves no crossing.
  std::optional<Estimate> arc_deg(const Jackknife& threshold);

  /// Where that arc lies, as the narrowest kernel sees the whole run.
  std::optional<CircleArc> narrowest_arc(double threshold);
  /// The direction of an angle of the circle.
  Direction direction(double angle_deg) const;

  /// Largest angle from the axis (gamma 0, or 180 if `up`) at which the threshold is reached, to either side,
  /// in the same way; with its values without each replicate.
  std::optional<Jackknife> reach_deg(const Jackknife& threshold, bool up);

 private:
  struct Smoothed {
    double radius_deg = 0.0;
    /// Of the whole run, then its draws (Jackknife::draws).
    std::vector<std::vector<CirclePoint>> circles;
  };
  const Smoothed& smoothed(std::size_t i);
  template <class Measure>
  std::optional<Jackknife> measured(std::size_t radius, const Jackknife& levels, const Measure& measure);
  template <class Measure>
  std::optional<Jackknife> best(const Jackknife& threshold, const Measure& measure);

  const CountedSphere& sphere_;
  double c_deg_, dark_cd_;
  std::vector<double> radii_deg_;
  std::vector<Smoothed> smoothed_;
};

}  // namespace lucerna
