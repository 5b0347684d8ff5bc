// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/evaluation/evaluation.h"

namespace lucerna {

/// What each zone of a mirror of revolution throws into the rings, tabulated over the zone's height and
/// slope: light that hits the mirror once is a sum over zones, each of which knows only where it is and how
/// it is tilted. A shape then costs some twenty microseconds instead of a trace, so that thousands can be
/// tried. Left out: second reflections and shadows, so what is found here is a start and never a result.
/// Immutable, thread safe.
///
/// In the plane through the axis light comes to a zone at the angle chi to -z, outward positive, and leaves a
/// face of slope angle theta at 2 theta - chi to z. Rows are kept by `turn`, the angle that light from the
/// source's middle leaves at: what moves with a zone's height is then its size alone, so that few heights do.
class ZoneTable {
 public:
  /// Over heights within `half_height_mm` of the base paraboloid of `family` (of revolution), from the first
  /// `count` rays, into `bins` (rings about the mirror's axis). `constant`: light that no zone makes, per
  /// bin. About 20 MB; two seconds of processor time for 4 M rays.
  ZoneTable(const DesignShape& family, const Reflectance& reflectance, const DesignRays& rays,
            std::uint64_t count, const TentBins& bins, double half_height_mm, Eigen::VectorXd constant);

  /// Flux and derivatives by the parameters of a shape of the family (on any knots), as `evaluate` gives
  /// them; no variance, no losses.
  Evaluation evaluate(const DesignShape& shape) const;

 private:
  struct Light;
  struct Grid;
  struct Arrival;
  float* row(std::size_t level, std::size_t zone, std::size_t turn) {
    return table_.data() + ((level * zone_r_mm_.size() + zone) * turns_ + turn) * rings_;
  }
  const float* row(std::size_t level, std::size_t zone, std::size_t turn) const {
    return table_.data() + ((level * zone_r_mm_.size() + zone) * turns_ + turn) * rings_;
  }
  double level_mm(std::size_t level) const {
    return static_cast<double>(level) * level_step_mm_ - half_height_mm_;
  }
  /// Angle chi of light from the source's middle at radius r and height z.
  double middle_chi(double r_mm, double z_mm) const;
  /// False where the ray does not meet the face.
  bool arrive(const DesignRays::Block& block, std::size_t i, double level_mm, Arrival& a) const;
  /// Cells for the light of the first blocks, and the turns.
  Grid make_grid(const DesignRays& rays, std::uint64_t blocks, double extent, double cell);
  void count(const DesignRays::Block& block, double level_mm, const Grid& grid, Light& light) const;
  /// For each level.
  std::vector<Light> arriving(const DesignRays& rays, std::uint64_t blocks, const Grid& grid) const;
  void fill(std::size_t level, std::size_t zone, const Light& light, const Reflectance& reflectance,
            const Grid& grid);

  std::vector<double> zone_r_mm_;
  std::size_t rings_ = 0, turns_ = 0;
  double base_per_r_ = 0.0;  ///< the base's slope is this times r
  double radius_mm_ = 0.0, hole_mm_ = 0.0;
  double half_height_mm_ = 0.0, level_step_mm_ = 0.0;
  double middle_z_mm_ = 0.0;
  /// Turns lie within `half_turn_` of straight along the bins' axis.
  double axis_turn_ = 0.0, half_turn_ = 0.0, turn_step_ = 0.0;
  Eigen::VectorXd constant_;
  std::vector<float> table_;
};

}  // namespace lucerna
