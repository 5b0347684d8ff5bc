// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "lucerna/reflector.h"

namespace lucerna {

/// A place in the plane, mm.
struct ArrayPoint {
  double x = 0.0, y = 0.0;
};

/// The cells of an array: squares or hexagons about equally spaced centres, one of which is the origin.
class ArrayCells {
 public:
  ArrayCells(double pitch_mm, bool is_hexagonal);

  /// Centre of the cell that (x, y) is in.
  ArrayPoint centre(double x_mm, double y_mm) const;
  /// From a cell's centre to those of the cells that share a side with it.
  const std::array<ArrayPoint, 6>& neighbours() const { return neighbours_; }
  int sides() const { return is_hexagonal_ ? 6 : 4; }
  /// From a centre to the corners of its cell.
  double corner_mm() const { return pitch_mm_ / (is_hexagonal_ ? std::numbers::sqrt3 : std::numbers::sqrt2); }

 private:
  double pitch_mm_;
  bool is_hexagonal_;
  std::array<ArrayPoint, 6> neighbours_{};
};

/// The same lenslet, a surface of revolution of second order, over every cell. Where cells meet it has an
/// edge and no step. Immutable and thread safe.
class LensArraySurface final : public HeightSurface {
 public:
  /// Throws InputError as `lens_array` does.
  explicit LensArraySurface(const LensArray& array);

  SurfacePoint at(double x_mm, double y_mm) const override;
  /// That of all cells.
  HeightRange range(const Rectangle& region) const override;

  const LensArray& array() const { return array_; }
  const ArrayCells& cells() const { return cells_; }

 private:
  /// Of the lenslet, at so far from its centre.
  SurfacePoint lenslet(double u_mm, double v_mm) const;

  LensArray array_;
  ArrayCells cells_;
};

}  // namespace lucerna
