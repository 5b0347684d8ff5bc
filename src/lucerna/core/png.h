// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>

namespace lucerna {

/// Writes a picture of 8-bit RGB pixels, row after row from the top (3 * width * height bytes, checked), as a
/// PNG file (ISO/IEC 15948). Throws InputError if the place cannot be written.
void write_png(const std::filesystem::path& path, std::size_t width, std::size_t height,
               std::span<const std::uint8_t> rgb);

}  // namespace lucerna
