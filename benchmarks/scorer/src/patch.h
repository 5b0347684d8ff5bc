// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "surface.h"

namespace bench {

/// A point of a surface of two parameters, and its derivatives.
struct SurfaceJet {
  Vec3 point, by_u, by_v;
};

/// A surface of two parameters, in its own frame, and what of it is there. Immutable; thread safe.
class Patch {
 public:
  virtual ~Patch() = default;
  /// At the nearest parameters that there are: they are moved there.
  virtual SurfaceJet jet(double& u, double& v) const = 0;
  /// Two parameters or more along an axis (0: u, 1: v), ascending. Between them it is smooth.
  virtual std::vector<double> breaks(std::size_t axis) const = 0;
  virtual bool straight(std::size_t axis) const = 0;
  virtual bool trimmed() const = 0;
  /// Is this place, with its point, within the trim?
  virtual bool keeps(double u, double v, const Vec3& point) const = 0;
  /// 1, or -1 where the normal looks against dP/du x dP/dv.
  virtual double side() const { return 1.0; }
};

/// As many quads as a patch can be cut into. It must not have more pieces of its own.
inline constexpr std::size_t kMaxQuads = 300'000;

/// The patch itself is traced: Embree finds a triangle of it, Newton's method the place.
std::unique_ptr<Surface> surface_of(std::unique_ptr<const Patch> patch, const Frame& place);

}  // namespace bench
