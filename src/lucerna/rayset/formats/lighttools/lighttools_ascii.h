// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// LightTools text ray data (.ray, .txt): "key: value" lines in any order, lt_startofdata, a line per ray,
/// lt_endofdata.
namespace lucerna {

bool looks_like_lighttools_ascii(const InputFile& file);

/// As the binary form (lighttools_binary.h): lengths become mm, the data origin counts, polarised rays have
/// four more columns, and a file without lt_endofdata was cut short.
std::unique_ptr<RayReader> open_lighttools_ascii(InputFile file, const ReadOptions& options = {});
std::unique_ptr<RayWriter> create_lighttools_ascii(const std::filesystem::path& path,
                                                   const RaySetHeader& header,
                                                   const WriteOptions& options = {});

}  // namespace lucerna
