// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace lucerna {

/// Writes a picture of 8-bit RGB pixels, row after row from the top (3 * width * height bytes, checked), as a
/// PNG file (ISO/IEC 15948). Throws InputError if the place cannot be written.
void write_png(const std::filesystem::path& path, std::size_t width, std::size_t height,
               std::span<const std::uint8_t> rgb);

/// A picture of numbers from 0 (black) to 1 (white), row after row from the top.
struct GreyImage {
  std::size_t width = 0, height = 0;
  std::vector<double> value;
  /// The level in the file that represents 1.
  double white = 255.0;
  /// The file has colours.
  bool colour = false;
};

/// Reads a PNG file of 8 or 16 bits a sample, grey, RGB or palette, with or without alpha (which is passed
/// over): samples as they are, without gamma; colours by their luminance (ITU-R BT.709). Throws InputError on
/// damage, an interlaced picture, fewer bits, or more than 16 M pixels.
GreyImage read_png_grey(const std::filesystem::path& path);

}  // namespace lucerna
