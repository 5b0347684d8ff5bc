// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "lucerna/design/evaluation/point_source.h"
#include "lucerna/design/evaluation/tent_bins.h"

namespace lucerna {

/// Where the light of a meridian has to go: the angle from +z within which a share of the prescribed flux is.
/// Immutable, thread safe.
class PrescribedAngle {
 public:
  /// `flux`: the target's in any bins of the lens's frame.
  explicit PrescribedAngle(const std::function<Eigen::VectorXd(const TentBins&)>& flux);

  /// In radians; `share` from 0 to 1.
  double of(double share) const;

 private:
  std::vector<double> within_;
};

/// The source's flux in rings of equal width of the angle from +z, from 0 to pi.
std::vector<double> meridian_light(const PointSource& source, int rings);

}  // namespace lucerna
