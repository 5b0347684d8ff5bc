// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

#include "lucerna/rays.h"

namespace lucerna {

/// How much étendue the brightest part of a light source's flux needs (characteristic curve, Ries and
/// Muschaweck, doi 10.1117/12.615874): regions of phase space in the order of falling luminance.
class EtendueCurve {
 public:
  /// So much étendue holds that share of the flux.
  struct Point {
    double flux, etendue;
  };
  EtendueCurve() = default;
  /// Both ascending, the first 0, 0.
  explicit EtendueCurve(std::vector<Point> points) : points_(std::move(points)) {}

  /// Étendue in mm^2 sr that holds the brightest `share` of the flux, 0 <= share <= 1; interpolated.
  double at(double share) const;

  /// True if the rays fill no volume of phase space (all through one point, or parallel): the curve is 0.
  bool degenerate() const { return points_.size() < 2; }

 private:
  std::vector<Point> points_;
};

/// The curve of a ray set, from the phase space where the lines cross the plane through their virtual focus
/// across their mean direction; rays less than 0.01 rad from that plane are left out (they have next to no
/// étendue there). The four-dimensional box of half the rays (by chance) is cut adaptively where a cut
/// explains the rays significantly better than none; the cells' luminance and order come from this half,
/// their flux from the other half, so that noise does not pass for brightness: trees cut at medians are
/// biased low. At most 2^20 rays, evenly spread, are used. Cost: about 1 s per million rays.
EtendueCurve etendue_curve(const RayBlock& rays);

}  // namespace lucerna
