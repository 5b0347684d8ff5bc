// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/evaluation.h"

namespace lucerna {

/// What each zone of a mirror of revolution throws into the rings, tabulated over the zone's height and
/// slope: light that meets the mirror once is a sum over zones, each of which knows only where it is and how
/// it is tilted. A shape then costs some ten microseconds instead of a trace, so that thousands can be tried.
/// Left out: second reflections and shadows, so what is found here is a start and never a result. Immutable,
/// thread safe.
class ZoneTable {
 public:
  /// Over heights within `half_height_mm` of the base paraboloid of `family` (of revolution), from the first
  /// `rays` rays, into `bins` (rings about the mirror's axis). `constant`: light that no zone makes, per bin.
  /// About 20 MB; half a second of processor time for 65 k rays.
  ZoneTable(const DesignShape& family, const Reflectance& reflectance, const DesignRays& rays,
            std::uint64_t count, const TentBins& bins, double half_height_mm, Eigen::VectorXd constant);

  /// Flux and derivatives by the parameters of a shape of the family (on any knots), as `evaluate` gives
  /// them; no variance, no losses.
  Evaluation evaluate(const DesignShape& shape) const;

 private:
  struct Zone {
    double r_mm, angle_rad;
  };
  float* row(std::size_t level, std::size_t zone, std::size_t tilt) {
    return table_.data() + ((level * zones_.size() + zone) * tilts_ + tilt) * rings_;
  }
  const float* row(std::size_t level, std::size_t zone, std::size_t tilt) const {
    return table_.data() + ((level * zones_.size() + zone) * tilts_ + tilt) * rings_;
  }
  void fill(std::size_t level, const DesignShape& family, const Reflectance& reflectance,
            const DesignRays& rays, std::uint64_t count, const TentBins& bins);

  std::vector<Zone> zones_;
  std::size_t rings_ = 0, tilts_ = 0;
  double half_height_mm_ = 0.0, level_step_mm_ = 0.0, half_tilt_ = 0.0, tilt_step_ = 0.0, slope_per_mm_ = 0.0;
  Eigen::VectorXd constant_;
  std::vector<float> table_;
};

}  // namespace lucerna
