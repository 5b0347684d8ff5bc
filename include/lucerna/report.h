// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lucerna/project.h"
#include "lucerna/trace.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Writes what `lucerna trace` leaves in a folder, which is made if it is missing: result.json, project.toml,
/// the raw sums, and for each detector NAME: far field NAME.ldt .ies .csv .svg, plane and luminance NAME.csv
/// .png, rays NAME with the ending of their format. `result` is a trace of `project.scene`. Files of these
/// names are replaced, each whole or not at all. Returns their names; what a format had to leave out goes to
/// `warnings`. Throws InputError where a file cannot be written. Reads all of the project's files, for their
/// hashes.
std::vector<std::string> write_trace(const std::filesystem::path& folder, const Project& project,
                                     const TraceResult& result, std::vector<std::string>* warnings = nullptr);

/// Writes the report of a folder that `write_trace`, `lucerna trace` or `lucerna design` has filled, as one
/// self-contained HTML file: figures with their errors, energy balance, diagrams, a 3D view; for a design
/// also target against result, limits, convergence. Throws InputError with file, place, found and expected
/// where the folder is neither. Where its project cannot be read any more the report says so. Cost: seconds.
void write_report(const std::filesystem::path& folder, const std::filesystem::path& html);

}  // namespace lucerna
#pragma GCC visibility pop
