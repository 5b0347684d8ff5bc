// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/photometric_metrics.h"
#include "lucerna/photometry/binning/counted_sphere.h"

namespace lucerna {

/// Whether the error of an angle is below a degree or a tenth of it (or not known).
bool is_determined(const Estimate& angle_deg);

/// Crossings of one section of counted flux, the great circle of the planes C and C + 180. Kernel means along
/// it are made once a radius and kept.
///
/// The error of a crossing is read off the confidence band of the section (E. C. Fieller, 1954): the places
/// where intensity and threshold are equal within their errors. Where the light crosses steeply that is noise
/// over slope. Where it runs level the band is wide, or wide to one side, and so is the error.
class Section {
 public:
  /// Radii from the cells' own up to `widest_deg` are tried. Below `dark_cd` values need no errors. The
  /// sphere must outlive it.
  Section(const CountedSphere& sphere, double c_deg, double widest_deg, double dark_cd);

  /// Full angle of the smallest arc that holds every direction with at least `threshold`, as `beam_angle_deg`
  /// has it. The noise of the threshold is taken to be independent of the section's. The section is smoothed
  /// with the smallest kernel for which the angle's error is small (half a per cent of it, within 0.1 and 0.5
  /// degrees), or with the one of least error; where another kernel sees another angle, that is part of the
  /// error. Nothing where the threshold is not reached, or the angle is not determined: its error is above a
  /// degree and a tenth of it, or the band allows that nothing reaches the threshold.
  std::optional<Estimate> arc_deg(const Estimate& threshold);

  /// Where that arc lies, as the narrowest kernel sees it, and how far outside of either of its ends noise
  /// allows that the threshold is reached.
  struct Place {
    CircleArc arc;
    double outward_deg = 0.0;
  };
  /// One place, or two where noise may decide which of two dark stretches is the wider one; none where the
  /// threshold is not reached, or the band has other stretches than the section.
  std::vector<Place> places(const Estimate& threshold);
  /// The direction of an angle of the circle.
  Direction direction(double angle_deg) const;

  /// Largest angle from the axis (gamma 0, or 180 if `up`) at which the threshold is reached, to either side,
  /// in the same way; with its values without each replicate.
  std::optional<Jackknife> reach_deg(const Jackknife& threshold, bool up);

 private:
  struct Smoothed {
    /// The section, and as high and as low as it may be.
    std::vector<CirclePoint> middle, high, low;
    /// The section with noise of its full size (Jackknife::draws).
    std::vector<std::vector<CirclePoint>> draws;
  };
  const Smoothed& smoothed(std::size_t i);
  struct Best {
    Estimate angle;
    /// Which of the radii it was taken with.
    std::size_t radius;
  };
  template <class Measure>
  std::optional<Best> best(const Measure& measure);

  const CountedSphere& sphere_;
  double c_deg_, dark_cd_;
  std::vector<double> radii_deg_;
  /// So many of the radii are for figures; one more may only show the bias of the last.
  std::size_t usable_ = 0;
  std::vector<Smoothed> smoothed_;
};

}  // namespace lucerna
