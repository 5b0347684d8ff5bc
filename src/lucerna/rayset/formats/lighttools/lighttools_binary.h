// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// LightTools binary ray data (.ray): "LTRF", a header of 44 bytes, 7 or 8 float32 per ray, "LTRFEND".
namespace lucerna {

bool looks_like_lighttools_binary(const InputFile& file);

/// Starts become mm and are counted from the header's data origin; far-field files have their starts there.
/// Version 3 (polarised; layout from one source, a warning says so) has four more columns. The count follows
/// from the file's size: a file without end marker is an error, or with `options.salvage` has as many rays as
/// are whole.
std::unique_ptr<RayReader> open_lighttools_binary(InputFile file, const ReadOptions& options = {});

/// Version 2. `options.length_unit`: mm, cm, m, inch, feet, um or nm.
std::unique_ptr<RayWriter> create_lighttools_binary(const std::filesystem::path& path,
                                                    const RaySetHeader& header,
                                                    const WriteOptions& options = {});

}  // namespace lucerna
