// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace lucerna {

/// A grey picture of up to 16 bits, rows from the top.
struct GreyImage {
  std::size_t width = 0, height = 0;
  /// The value that stands for white.
  std::uint32_t white = 0;
  std::vector<std::uint16_t> grey;
};

/// Reads a grey PNG of 8 or 16 bits without interlace (ISO/IEC 15948: filters 0 to 4, checksums checked).
/// Throws InputError with file and byte on damage, colour, a palette, or more than 2^26 pixels. Thread safe.
GreyImage read_grey_png(const std::filesystem::path& path);

/// Reads a PGM picture, binary (P5) or text (P2), white at most 65535. Errors alike.
GreyImage read_pgm(const std::filesystem::path& path);

}  // namespace lucerna
