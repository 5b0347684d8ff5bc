// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

namespace lucerna {

/// Illuminance on an even grid over a rectangle, from a file: what a design is asked for on a plane.
struct IlluminanceMap {
  /// Cells along x and y; value of cell (ix, iy), both from the negative side, at iy * nx + ix. Never
  /// negative, not all zero. In lx (W/m2 for radiometric sources) or, from a picture, in its white.
  std::size_t nx = 0, ny = 0;
  std::vector<double> value;

  /// At a place of the rectangle, u and v in [-1, 1] from side to side: bilinear between cell centres, level
  /// from the outermost centres to the sides; 0 outside the rectangle. O(1).
  double at(double u, double v) const;
};

/// Reads numbers in rows (',' ';' tab or blanks between them, '.' for decimals): the first row is the side of
/// +y, the first column that of -x, as a picture lies. Or, where the first line is a header with x_mm and
/// y_mm, the third column at those places, which must fill an even grid (its cells' centres); what `trace`
/// writes for a plane. Lines that are empty or begin with '#' count not. Throws InputError with file, line,
/// found and expected. At most 16 M cells.
IlluminanceMap read_illuminance_csv(const std::filesystem::path& path);

/// A PNG picture: black is no light, white 1, linear in between (colours by their luminance), its top side
/// +y. Errors as in `read_png_grey`.
IlluminanceMap read_illuminance_png(const std::filesystem::path& path);

}  // namespace lucerna
