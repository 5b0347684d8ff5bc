// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "lucerna/design/problem/design_limits.h"
#include "lucerna/design/solver/residual_rows.h"

namespace lucerna {

/// Between which heights a surface is to be at a place, in mm.
struct HeightBounds {
  double x_mm, y_mm, low_mm, high_mm;
};

/// The limits on a mirror's form as costs that a fit can add to its error. At places over the aperture, each
/// limit costs the square of its excess over a small margin (0.02 mm, 0.01 of slope, 2 % of curvature), from
/// a margin inside the limit on: a margin too much costs as much as an error of 100 %. What is not linear in
/// the parameters (curvature) has Gauss-Newton derivatives. Immutable, thread safe.
class ShapeLimits {
 public:
  /// `start` says the aperture and on which side of each keep-out zone the mirror is to stay: where most of
  /// it is to begin with. `bounds`: heights that it is to stay between, too.
  ShapeLimits(const DesignLimits& limits, const DesignShape& start,
              std::span<const HeightBounds> bounds = {});

  bool empty() const { return limits_.empty(); }

  /// The cost of all limits, 0 where all are held; adds its residuals to `rows` unless null.
  double cost(const DesignShape& shape, ResidualRows* rows) const;

  /// True if every limit itself, without margin, is held on a fine grid.
  bool held(const DesignShape& shape) const;

  /// The shape itself if it holds the limits; else one near it, of the same knots, that does; nothing where
  /// none is found.
  std::optional<DesignShape> held_nearby(const DesignShape& shape) const;
  /// The same; throws InputError if there is none, naming the pair of limits that contradict each other.
  DesignShape nearest(const DesignShape& shape) const;

 private:
  enum class Kind { height, slope, radius, keep_out };
  struct Place {
    double x, y;
  };
  /// What keeps the surface away from a zone over one place.
  struct Wall {
    Place place;
    double z_mm;
    bool below;  ///< the surface must be below z
  };
  struct Limit {
    Kind kind;
    double value;
    std::string text;
    std::vector<Wall> walls;
  };
  struct Terms;

  /// Where the limits look at the surface.
  static std::vector<Place> places(const DesignShape& shape, std::span<const Limit* const> limits,
                                   int per_interval);
  Limit keep_out(const KeepOut& zone, const DesignShape& start) const;
  bool held(const DesignShape& shape, std::span<const Limit* const> limits) const;
  /// `per_interval`: places looked at in a knot interval.
  double cost(const DesignShape& shape, std::span<const Limit* const> limits, int per_interval,
              ResidualRows* rows) const;
  /// A shape that holds them, if Gauss-Newton on the costs alone finds one.
  std::optional<DesignShape> solve(const DesignShape& shape, std::span<const Limit* const> limits) const;
  std::vector<const Limit*> all() const;

  std::vector<Limit> limits_;
};

}  // namespace lucerna
