// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/constraints/zone_cost.h"
#include "lucerna/design/problem/target_rectangle.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

/// Where in the schedule an initial guess begins: with few knots, which leave the details to what the light
/// asks for; with most of its own; or after the screening stage, where it is known to be near.
enum class InitialKnots { few_knots, own_knots, end };

/// A shape that a fit may begin with.
struct InitialGuess {
  DesignShape shape;
  InitialKnots entry = InitialKnots::few_knots;
  /// Relative RMS^2 with limits, in a third of the bins.
  double cost = 0.0;
};

/// What is fitted: all that stays the same while the shape changes.
struct FitProblem {
  DesignRays* rays = nullptr;
  Reflectance reflectance{1.0};
  /// Flux that the target puts into any bins over its window, as shares of the sources' flux.
  std::function<Eigen::VectorXd(const TentBins&)> target;
  /// The bins in which the result is evaluated.
  TentBins bins;
  TargetMode mode = TargetMode::shape;
  bool direct_light = true;
  /// In shape mode, where the scale is free, light beside the window would cost nothing: flux_weight times
  /// the square of what the share in the window lacks of flux_reference is added to the cost
  /// (missing_light.h). Weight 0 = not.
  double flux_weight = 0.0, flux_reference = 1.0;
  /// What differences in bins beside the target's rectangle count, of those within it. Free forms only.
  double outside_weight = 1.0;
  /// What the limits cost at a shape, to be added to the squared error: 0 where all are held. Adds its
  /// residuals to `rows` unless null. Limits on light trace the first `rays` rays. Empty: no limits.
  std::function<double(const DesignShape&, std::uint64_t rays, ResidualRows* rows)> limits;
  /// What a shape costs that passes the source, with or without limits. Empty: nothing.
  std::function<double(const DesignShape&, ResidualRows* rows)> in_front;
  /// Both.
  double limits_cost(const DesignShape& shape, std::uint64_t from_rays, ResidualRows* rows) const {
    return (limits ? limits(shape, from_rays, rows) : 0.0) + (in_front ? in_front(shape, rows) : 0.0);
  }
  /// Those of both that are on the form, for steps that look ahead at them; may be null.
  std::shared_ptr<const ShapeLimits> form;
  /// Brings what a search begins with within limits on its heights; nothing where it is too far beyond them
  /// to be a start. Empty: it begins as it is.
  std::function<std::optional<DesignShape>(const DesignShape&)> within;
  /// Flux, as an evaluation has it, that a shape sends into bins by ways that an evaluation does not
  /// follow, looked at by some of `rays` rays. A free form's levels keep that of the shape that they begin
  /// with. Empty: none.
  std::function<Eigen::VectorXd(const DesignShape&, const TentBins&, std::uint64_t rays)> other_light;
  /// Shapes to begin with, the most promising first; empty: the shape that the fit is made with.
  std::vector<InitialGuess> guesses;
  /// So many of them are compared at the screening stage before the best goes on; further ones are the first
  /// restarts.
  std::size_t compared = 5;
  /// Free forms: what the search begins with was chosen among others, so that it goes on before others begin.
  bool start_is_chosen = false;
  /// Rays that were traced to find them.
  std::uint64_t search_rays = 0;
  /// While the result is above the noise the fit restarts, alternately from `guesses` and from the incumbent,
  /// perturbed (free forms: from the search for basins and from the incumbent). So many restarts in a row
  /// that gain nothing end it. 0: neither restarts nor a search.
  int max_failed_restarts = 6;
  /// Size of a perturbation, over the mirror's outer radius; those of the search are twice as large.
  double perturbation = 0.02;
  std::uint64_t seed = 1;
  /// Of the target, and where it is seen from.
  TargetRectangle rectangle;
  Frame mirror_from_world;
  /// Bounds on the light of zones; without cells: none. Free forms of many knots only.
  ZoneBands zones;
};

}  // namespace lucerna
