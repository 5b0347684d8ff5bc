// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// Ansys SPEOS ray files (.ray): 7 float32 (watts, five times the version, lumens), then 8 float32 per ray:
/// start in mm, direction, wavelength in nm, relative energy. No magic number and no count.
namespace lucerna {

/// True if the five version numbers are equal and make sense.
bool looks_like_speos(const InputFile& file);

/// Weights are watts where the header has them, else lumen. A polarised file has 5 more columns. The count
/// follows from the file's size, so that a file cut between two rays cannot be told from a whole one.
std::unique_ptr<RayReader> open_speos(InputFile file, const ReadOptions& options = {});

/// Every ray has a wavelength here (RayWavelengths), 555 nm where none is known; warnings say so, and where
/// they are drawn.
std::unique_ptr<RayWriter> create_speos(const std::filesystem::path& path, const RaySetHeader& header,
                                        const WriteOptions& options = {});

}  // namespace lucerna
