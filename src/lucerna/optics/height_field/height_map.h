// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace lucerna {

/// Heights on an even grid, in the units of a file.
struct HeightMap {
  std::size_t nx = 0, ny = 0;
  /// Row after row from the lowest y, x fastest.
  std::vector<double> z;
  /// A picture: z is grey, 0 to this value; nothing where z are the file's own numbers.
  std::optional<double> white;
};

/// Where the file's first row lies: at the largest y, as a picture is looked at, or at the lowest.
enum class FirstRow { top, bottom };

/// Reads a sampled surface by the file's ending: .csv .txt (numbers parted by commas, semicolons or blanks, a
/// line a row, # begins a comment), .npy (NumPy 1 to 3, two-dimensional, integers of 8 to 32 bits or floats,
/// either byte order, rows or columns first), .pgm and .png (grey, 8 or 16 bits). Throws InputError with file
/// and line, row or byte on a number that is missing or not finite, ragged rows, another type, fewer than 4 x
/// 4 or more than 2^24 heights. O(bytes); thread safe.
HeightMap read_height_map(const std::filesystem::path& path, FirstRow first_row = FirstRow::top);

}  // namespace lucerna
