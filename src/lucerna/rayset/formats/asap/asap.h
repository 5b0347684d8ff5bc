// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// ASAP distribution files with rays (.dis): Fortran direct-access records of LENR 4-byte words, five of them
/// header. Known from two descriptions, not from files of ASAP's own.
namespace lucerna {

bool looks_like_asap(const InputFile& file);

/// Any record length from 7 words; columns as the field label names them, further ones become additional.
/// Lengths become mm. The label says lm or W in files of ours; else lumen is assumed with a warning.
std::unique_ptr<RayReader> open_asap(InputFile file, const ReadOptions& options = {});

/// Records of 7 words. `options.length_unit`: mm, cm, m or inch. At most 2^31 - 1 rays.
std::unique_ptr<RayWriter> create_asap(const std::filesystem::path& path, const RaySetHeader& header,
                                       const WriteOptions& options = {});

}  // namespace lucerna
