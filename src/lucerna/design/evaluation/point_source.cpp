// SPDX-License-Identifier: Apache-2.0
#include "lucerna/design/evaluation/point_source.h"

#include <Eigen/Dense>
#include <algorithm>

#include "lucerna/trace/tally/flux_quanta.h"

namespace lucerna {

PointSource point_source(const DesignRays& rays, std::uint64_t count) {
  PointSource source;
  Eigen::Matrix3d a = Eigen::Matrix3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  double weight = 0.0;
  const std::uint64_t blocks = std::min(count, rays.size()) / kBlockRays;
  for (std::uint64_t i = 0; i < blocks; ++i) {
    const DesignRays::Block& block = rays.block(i);
    for (std::size_t k = 0; k < kBlockRays; ++k) {
      const Eigen::Vector3d o(block.x_mm[k], block.y_mm[k], block.z_mm[k]);
      const Eigen::Vector3d d(block.kx[k], block.ky[k], block.kz[k]);
      const double w = block.weight[k];
      const Eigen::Matrix3d across = w * (Eigen::Matrix3d::Identity() - d * d.transpose());
      a += across;
      b += across * o;
      weight += w;
      source.light.push_back({Direction::from({d.x(), d.y(), d.z()}), w});
    }
  }
  for (DirectedFlux& l : source.light) l.flux /= weight;
  const Eigen::Vector3d at = a.ldlt().solve(b);  // the least sum of squared distances to the rays
  source.at_mm = {at.x(), at.y(), at.z()};
  return source;
}

}  // namespace lucerna
