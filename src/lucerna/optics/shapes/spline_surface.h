// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "lucerna/reflector.h"

namespace lucerna {

/// A free-form surface: a uniform bicubic B-spline over a rectangle, by itself or added to another surface.
/// C2 inside; beyond the rectangle it goes on as the outermost patches do for a tenth of a size and then
/// stays level in the gradient.
class SplineSurface final : public HeightSurface {
 public:
  /// `coefficients` row after row (x fastest), nx * ny of them, each at least 4: (nx - 3) x (ny - 3) patches
  /// fill `region`. `base` may be null. Throws InputError on fewer than 4 a side, a wrong number of
  /// coefficients or a value that is not finite.
  SplineSurface(const Rectangle& region, std::size_t nx, std::size_t ny, std::vector<double> coefficients,
                std::shared_ptr<const HeightSurface> base = nullptr);

  /// The spline through nx * ny heights on an even grid whose first and last lines are the sides of `region`,
  /// with zero third differences at the ends (not-a-knot). nx, ny >= 4. O(nx ny). Errors as above.
  static SplineSurface through(const Rectangle& region, std::size_t nx, std::size_t ny,
                               const std::vector<double>& heights_mm);

  /// O(1): 16 coefficients.
  SurfacePoint at(double x_mm, double y_mm) const override;
  /// From the coefficients: a spline stays between the minimum and maximum that reach into a patch.
  HeightRange range(const Rectangle& region) const override;
  /// From the coefficients, too: second derivatives of each patch lie between minima and maxima of second
  /// differences, which may leave a convex patch undecided. O(patches of the region).
  bool convex_over(const Rectangle& region) const override;

  std::size_t nx() const { return nx_; }
  std::size_t ny() const { return ny_; }
  const std::vector<double>& coefficients() const { return coefficients_; }

 private:
  bool convex_patch(std::size_t px, std::size_t py) const;

  Rectangle region_;
  std::size_t nx_, ny_;
  double step_x_, step_y_;
  std::vector<double> coefficients_;
  std::shared_ptr<const HeightSurface> base_;
};

}  // namespace lucerna
