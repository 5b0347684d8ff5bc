// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "lucerna/reflector.h"

namespace lucerna {

/// A quadtree of height ranges over a reflector's aperture: a maximum mipmap (A. Tevs, I. Ihrke, H.-P.
/// Seidel, "Maximum mipmaps for fast, accurate, and scalable dynamic height field rendering", I3D 2008) that
/// keeps minima too, since light may come from either side. Level 0 is the root; level k has 2^k x 2^k cells.
/// Ranges hold the exact surface, not samples of it; cells wholly off the mirror are empty. Immutable, thread
/// safe; 17 bytes per cell of all levels.
class HeightMipmap {
 public:
  /// 2^levels cells a side at the finest level.
  HeightMipmap(const Reflector& reflector, int levels);

  int levels() const { return levels_; }
  const Rectangle& region() const { return region_; }

  /// The place of grid line `i` of level `level`, the same number however it is reached.
  double line_x_mm(int level, std::size_t i) const {
    return region_.x0_mm + static_cast<double>(i << (levels_ - level)) * step_x_mm_;
  }
  double line_y_mm(int level, std::size_t i) const {
    return region_.y0_mm + static_cast<double>(i << (levels_ - level)) * step_y_mm_;
  }

  /// Heights in a cell; empty cells have low > high.
  const HeightRange& cell(int level, std::size_t ix, std::size_t iy) const {
    return cells_[static_cast<std::size_t>(level)][(iy << level) + ix];
  }
  /// True if the surface is known to be convex over the cell, on the mirror or off it.
  bool convex(int level, std::size_t ix, std::size_t iy) const {
    return convex_[static_cast<std::size_t>(level)][(iy << level) + ix] != 0;
  }

 private:
  int levels_;
  Rectangle region_;
  double step_x_mm_, step_y_mm_;
  std::vector<std::vector<HeightRange>> cells_;
  std::vector<std::vector<char>> convex_;
};

}  // namespace lucerna
