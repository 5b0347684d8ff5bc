// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lucerna/core/image/png.h"

namespace lucerna {

/// Reads a PGM picture (netpbm), binary (P5) or text (P2), of at most 65535 levels and 16 M pixels. Throws
/// InputError with file and byte. Thread safe.
GreyImage read_pgm(const std::filesystem::path& path);

}  // namespace lucerna
