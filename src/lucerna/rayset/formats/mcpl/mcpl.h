// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// MCPL particle lists, version 3 (Kittelmann et al., Comput. Phys. Commun. 218, 17, 2017), little-endian:
/// what McXtrace, Geant4, OpenMC and others exchange. Rays are the photons.
namespace lucerna {

/// By the first four bytes, also of what a gzip file unpacks to.
bool looks_like_mcpl(const InputFile& file);

/// Plain or gzip. Photons are particles of PDG code 22 and -22 (Geant4's optical photons); any other is a
/// faulty ray. A ray's weight is its power in watts, weight x energy, where weights are photons per second.
/// Every ray has a wavelength; user flags and polarisation become additional columns. Times, comments and
/// blobs are not kept. The total flux is known from files of ours only.
std::unique_ptr<RayReader> open_mcpl(InputFile file, const ReadOptions& options = {});

/// Double precision, PDG code 22 for all, not packed. Two of three direction cosines keep their bits, the
/// largest is what makes the direction unit. Lengths are cm in the file: `options.length_unit` is "mm" (no
/// choice made) or "cm".
std::unique_ptr<RayWriter> create_mcpl(const std::filesystem::path& path, const RaySetHeader& header,
                                       const WriteOptions& options = {});

}  // namespace lucerna
