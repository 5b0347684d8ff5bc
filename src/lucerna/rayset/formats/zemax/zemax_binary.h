// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// Zemax OpticStudio binary source files (.dat, .sdf), and those that ProSource, TracePro and OPTICAD write
/// alike: a header of 208 bytes, then 7 (flux only) or 8 (spectral) float32 per ray.
namespace lucerna {

/// True if the header's identifier and codes are those of this format.
bool looks_like_zemax_binary(const InputFile& file);

/// Lengths become mm, micrometres nm. The total is the header's RaySetFlux, else its SourceFlux; OpticStudio
/// uses neither. A spectral file whose flux column holds visible wavelengths and whose wavelength column
/// holds none has the two swapped: an error, which `options.salvage` turns into a warning and undoes.
std::unique_ptr<RayReader> open_zemax_binary(InputFile file, const ReadOptions& options = {});

/// Identifier 1010. Rays with wavelengths make a spectral file, which the format allows for watts only: for
/// lumen the wavelengths are left out with a warning. `options.length_unit`: mm, m, inch, cm or feet.
std::unique_ptr<RayWriter> create_zemax_binary(const std::filesystem::path& path, const RaySetHeader& header,
                                               const WriteOptions& options = {});

}  // namespace lucerna
