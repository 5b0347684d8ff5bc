// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// Zemax OpticStudio text source files: "NbrRays DimensionUnits [format flux_type]", then 7 or 8 numbers per
/// line. The format states no total flux.
namespace lucerna {

bool looks_like_zemax_text(const InputFile& file);

/// The number of columns decides between flux only and spectral, with a warning where the first line says
/// otherwise.
std::unique_ptr<RayReader> open_zemax_text(InputFile file, const ReadOptions& options = {});
std::unique_ptr<RayWriter> create_zemax_text(const std::filesystem::path& path, const RaySetHeader& header,
                                             const WriteOptions& options = {});

}  // namespace lucerna
