// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "lucerna/design/evaluation/design_rays.h"
#include "lucerna/design/evaluation/tent_bins.h"
#include "lucerna/design/shape/design_shape.h"

namespace lucerna {

/// Which of a point source's mirrors: `sign` as PointTransport has it, and how far the vertex is from the
/// source.
struct TransportChoice {
  double sign = 1.0, vertex_distance_mm = 0.0;
  constexpr bool exists() const { return vertex_distance_mm > 0.0; }
};

/// What a start by transport is made for.
struct TransportProblem {
  const DesignRays* rays = nullptr;
  std::uint64_t ray_count = std::uint64_t{1} << 19;
  double reflectance = 1.0;
  bool direct_light = true;
  /// Flux prescribed in each bin, in any unit.
  Eigen::VectorXd target;
  /// Square bins or those of a plane, over the window and a little more.
  TentBins bins;
  /// Cells across the source's light, and the rounds in which what the aperture catches is found.
  int source_cells = 40, rounds = 4;
};

/// The free form that would throw the source's light as prescribed, were the source a point: the light that
/// the aperture catches (less what enters its hole) is transported onto the target (less the light that
/// passes the mirror), in rounds, because what it catches follows from the shape. `family` says aperture,
/// knots and symmetry. Nothing where the source is not in front of such a mirror or no light is left for it,
/// or where a lens's face catches too little of the light within. About two processor seconds.
std::optional<DesignShape> transport_guess(const TransportProblem& problem, const DesignShape& family,
                                           const TransportChoice& choice);

/// A height over a place that a spline is to go through.
struct SurfacePointWeight {
  double x_mm, y_mm, z_mm, weight;
};

/// The shape of `family` nearest to points by least squares; where there are none it is as smooth as it can
/// be.
DesignShape fitted_to_points(const DesignShape& family, const std::vector<SurfacePointWeight>& points);

}  // namespace lucerna
