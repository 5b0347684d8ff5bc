// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/problem/design_limits.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

/// The limits on a mirror's light as costs that a fit can add to its error: they trace the design's rays once
/// more. Immutable, thread safe.
class LightLimits {
 public:
  LightLimits(const DesignLimits& limits, const Reflectance& reflectance);

  bool empty() const { return !glare_ && !min_efficiency_; }

  /// From 5 % inside a limit on, the square of the excess over 5 % of it. Glare in cells of about 5 by 30
  /// degrees (gamma, C) about the mirror's axis, with exact derivatives; efficiency without (that it depends
  /// on the shape at all is a matter of bounces and of the mirror's back). Adds gradient and Hessian to
  /// `equations` unless null. Cost: one evaluation for each of the two.
  double cost(const DesignShape& shape, const DesignRays& rays, std::uint64_t n, ResidualRows* rows) const;

  /// Throws InputError where min_efficiency and the reflectance contradict each other: where the light that
  /// must meet a mirror over this aperture, be it shaped as it may, already loses more. That light: within 45
  /// degrees of the mirror's -z and of the aperture's axis side, not through the hole, and twice as far from
  /// its rim as the shape could move it. A lower bound.
  void check(const DesignShape& start, const DesignRays& rays) const;

 private:
  Evaluation trace(const DesignShape& shape, const DesignRays& rays, std::uint64_t n, const TentBins& bins,
                   bool derivatives) const;

  std::optional<GlareLimit> glare_;
  std::optional<double> min_efficiency_;
  Reflectance reflectance_;
  std::optional<TentBins> zone_;
};

}  // namespace lucerna
