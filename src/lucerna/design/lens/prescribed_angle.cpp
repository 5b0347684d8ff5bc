// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/lens/prescribed_angle.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace lucerna {

namespace {

constexpr int kRings = 360;

}  // namespace

PrescribedAngle::PrescribedAngle(const std::function<Eigen::VectorXd(const TentBins&)>& flux)
    : within_(kRings + 1, 0.0) {
  const Eigen::VectorXd rings = flux(TentBins::rings(Frame(), std::numbers::pi, kRings));
  for (std::size_t i = 0; i < kRings; ++i)
    within_[i + 1] = within_[i] + std::max(0.0, rings[static_cast<Eigen::Index>(i)]);
}

double PrescribedAngle::of(double share) const {
  // Nothing and all are reached at the ends of the light, not of the rings without any.
  const double want = std::max(share, 1e-12) * within_.back();
  const auto at = std::lower_bound(within_.begin() + 1, within_.end() - 1, want);
  const double step = std::max(*at - *(at - 1), 1e-300);
  const double i =
      static_cast<double>(at - within_.begin()) - 1.0 + std::clamp((want - *(at - 1)) / step, 0.0, 1.0);
  return i * std::numbers::pi / kRings;
}

std::vector<double> meridian_light(const PointSource& source, int rings) {
  std::vector<double> out(static_cast<std::size_t>(rings), 0.0);
  for (const DirectedFlux& l : source.light) {
    const double theta = std::acos(std::clamp(l.direction.z(), -1.0, 1.0));
    const auto ring = static_cast<std::size_t>(rings * theta / std::numbers::pi);
    out[std::min(ring, out.size() - 1)] += l.flux;
  }
  return out;
}

}  // namespace lucerna
