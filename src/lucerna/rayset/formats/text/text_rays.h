// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>

#include "lucerna/core/io/file.h"
#include "lucerna/ray_file.h"

/// Any text with one ray per line: what TracePro, FRED, spreadsheets and scripts write.
namespace lucerna {

/// True if among the first lines there is one of 7 or more numbers, of which the 4th to 6th are a unit
/// direction, or a comment "# columns:"; and it is no other text format.
bool looks_like_text_rays(const InputFile& file);

/// Lines before the first that is all numbers are skipped. Columns are what ReadOptions::text_columns says,
/// else what "# columns: ..." says, else x y z kx ky kz flux and further ones unnamed. Names: x, y, z (with
/// _mm, _cm, _m, _inch, ...), kx, ky, kz, flux (flux_lm, flux_w), wavelength_nm, wavelength_um; "-" leaves a
/// column out, any other name makes an additional column. The total is "# flux_lm: 337" or "# flux_w: ...";
/// without a unit lumen is assumed with a warning.
std::unique_ptr<RayReader> open_text_rays(InputFile file, const ReadOptions& options = {});

/// Writes "# columns:" and "# flux_lm:" comments that the reader understands, and all columns.
std::unique_ptr<RayWriter> create_text_rays(const std::filesystem::path& path, const RaySetHeader& header,
                                            const WriteOptions& options = {});

}  // namespace lucerna
