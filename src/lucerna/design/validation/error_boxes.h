// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "lucerna/design/problem/target_rectangle.h"

namespace lucerna {

/// Boxes a side in which a design's error is measured at its finest. 24 and 12 a side are sums of these.
inline constexpr int kErrorBoxes = 48;

/// The cells of a design's error (docs/theory/design.md): the target's rectangle in 48 x 48 equal boxes
/// with hard edges, and cells of the same size over the rest of the sphere. Cells are numbered: the boxes of
/// the rectangle (iv * 48 + iu, from the negative sides), then the rest. Immutable and thread safe.
///
/// The rest, for directions: the rectangle's grid continued over both hemispheres, in multiples of the boxes
/// where more than 256 a side would be needed; for a plane: the grid continued to three times the rectangle,
/// and a last cell without measure for all light that does not fall there.
class ErrorBoxes {
 public:
  explicit ErrorBoxes(const TargetRectangle& rectangle);

  const TargetRectangle& rectangle() const { return rectangle_; }
  std::size_t size() const { return measure_.size(); }
  static constexpr std::size_t kInside = std::size_t{kErrorBoxes} * kErrorBoxes;

  /// The cell that a ray of the luminaire frame falls into, by its last leg.
  std::size_t cell(const Vec3& origin_mm, const Vec3& direction) const;

  /// Solid angle of the cells in sr, or area in mm2. 0 for cells beyond the horizon and for slivers at it
  /// (less than a hundredth of a whole cell, where a ray or two would be a huge intensity): these count in
  /// sums of light, not in errors.
  const std::vector<double>& measure() const { return measure_; }

  /// Flux per cell of an intensity in directions of the luminaire frame: integrals over the exact cells
  /// (Gauss-Legendre in u and in the angle that makes the solid angle uniform in v). `step_rad`: the distance
  /// over which the intensity bends, as the step of its table. Some 0.1 s. Not for planes.
  std::vector<double> flux_of(const std::function<double(const Direction&)>& intensity,
                              double step_rad) const;
  std::vector<double> flux_of(const IntensityDistribution& distribution) const;
  /// The same of a density per mm2 over places of the plane. `step_mm` as above. For planes only.
  std::vector<double> flux_on(const std::function<double(double x_mm, double y_mm)>& density_per_mm2,
                              double step_mm) const;

 private:
  struct Range {
    double u0, u1, v0, v1;
  };
  /// Cell of the outer grid: which hemisphere (0 towards the axis) and where.
  Range outer_range(std::size_t column, std::size_t row) const;
  Range inner_range(std::size_t box) const;
  bool in_rectangle(const Range& r) const;
  std::size_t outer_cell(double u, double v, bool behind) const;
  void set_outer_grid();
  void drop_slivers();
  double integral(const Range& r, bool behind, int pieces,
                  const std::function<double(const Direction&)>& intensity) const;

  TargetRectangle rectangle_;
  double step_u_, step_v_;
  /// Of the outer grid: boxes a cell, first column and row in such cells, their counts.
  int multiple_ = 1;
  long first_column_ = 0, first_row_ = 0;
  std::size_t columns_ = 0, rows_ = 0;
  std::vector<double> measure_;
};

inline std::size_t ErrorBoxes::cell(const Vec3& origin_mm, const Vec3& direction) const {
  const Frame& f = rectangle_.world_from_rectangle;
  double u = dot(direction, f.ex()), v = dot(direction, f.ey());
  const double w = dot(direction, f.ez());
  if (rectangle_.is_plane) {
    const Vec3 from = origin_mm - f.origin_mm();
    const double height = dot(from, f.ez());
    if (!(w < 0.0 && height >= 0.0)) return measure_.size() - 1;
    u = dot(from, f.ex()) - height / w * u;
    v = dot(from, f.ey()) - height / w * v;
  }
  const bool behind = !rectangle_.is_plane && !(w > 0.0);
  const double i = std::floor((u - rectangle_.u_min) / step_u_);
  const double j = std::floor((v - rectangle_.v_min) / step_v_);
  if (!behind && i >= 0.0 && j >= 0.0 && i < kErrorBoxes && j < kErrorBoxes) {
    return static_cast<std::size_t>(j) * kErrorBoxes + static_cast<std::size_t>(i);
  }
  return outer_cell(i, j, behind);
}

}  // namespace lucerna
