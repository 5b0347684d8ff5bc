// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/evaluation/design_rays.h"

namespace lucerna {

/// So much of the light may start behind a designed mirror beyond what starts behind the given one.
inline constexpr double kMaxBehind = 1e-3;

/// Share of the light that starts over the mirror's aperture and behind it, by the first 4096 rays.
double share_behind(const DesignShape& shape, const DesignRays& rays);

/// Keeps a mirror in front of which the light starts from passing the source, which is a body too. Immutable,
/// thread safe; `rays` must outlive it.
class SourceSide {
 public:
  /// Where `given` has passed the source, a shape may, too.
  SourceSide(const DesignShape& given, const DesignRays& rays);

  /// Heights that the surface is to stay below, in its frame, where those rays start; of starts above one
  /// another the lower ones. None is nearer to the given mirror than costs begin.
  const std::vector<HeightBounds>& bounds() const { return bounds_; }

  /// 0 where they are held by 0.04 mm. Else the hinges of `bounds`, added to `rows` unless null, and as much
  /// as an error of 100 % for kMaxBehind. A shape that is far below the source is known by one look a cell.
  double cost(const DesignShape& shape, ResidualRows* rows) const;

  /// The nearest shape of the same knots that holds them; nothing where there is none, or where so much of
  /// the source was passed that the shape is none for it.
  std::optional<DesignShape> within(const DesignShape& shape) const;

 private:
  /// A place of the source seen along the axis, and the lowest bound about it.
  struct Cell {
    double x_mm, y_mm, low_mm;
  };
  bool is_near(const DesignShape& shape) const;

  const DesignRays& rays_;
  double given_behind_;
  std::vector<HeightBounds> bounds_;
  double cell_mm_ = 0.0;
  std::vector<Cell> cells_;
  ShapeLimits walls_;
};

}  // namespace lucerna
