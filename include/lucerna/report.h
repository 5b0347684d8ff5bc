// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "lucerna/design.h"
#include "lucerna/progress.h"
#include "lucerna/project.h"
#include "lucerna/trace.h"
#include "lucerna/trace_metrics.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// Writes what `lucerna trace` leaves in a folder, which is made if it is missing: result.json, project.toml,
/// the raw sums, and for each detector NAME: far field NAME.ldt .ies .csv .svg, plane and luminance NAME.csv
/// .png, rays NAME with the ending of their format. `result` is a trace of `project.scene`. Files of these
/// names are replaced, each whole or not at all; what of the project is in memory is written, too. Returns
/// their names; what the figures may mislead about and what a format had to leave out goes to `warnings`.
/// Throws InputError where a file cannot be written. Reads all of the project's files, for their hashes.
std::vector<std::string> write_trace(const std::filesystem::path& folder, const Project& project,
                                     const TraceResult& result, std::vector<std::string>* warnings = nullptr);
/// The same with the figures of the trace, `trace_metrics(result, project.scene)`, where they are there
/// already.
std::vector<std::string> write_trace(const std::filesystem::path& folder, const Project& project,
                                     const TraceResult& result, const TraceMetrics& figures,
                                     std::vector<std::string>* warnings = nullptr);

/// Writes what `lucerna design` leaves in a folder, which is made if it is missing: what `write_trace` leaves
/// of the finished project, and reflector.toml .step .stl .obj .dxf .csv, history.csv, checkpoint,
/// tolerances.csv; of a lens lens.toml .step .stl .obj, .dxf and .csv unless its face is a free form, and
/// history.csv. Errors and what is returned as `write_trace`.
std::vector<std::string> write_design(const std::filesystem::path& folder, const DesignedMirror& mirror);

/// Writes the report of `input` as one self-contained HTML file. Of a folder that `write_trace`, `lucerna
/// trace` or `lucerna design` has filled: figures with their errors, energy balance, diagrams, a 3D view; for
/// a design also target against result, limits, convergence; where its project cannot be read any more the
/// report says so. Of a source model (.nfl): its figures, its luminance from any direction, and, with
/// `ray_files`, how far it is from their rays (4 M of them at most). Progress phase "report: rays". Cost:
/// seconds. Throws InputError with file, place, found and expected where `input` is none of these, and
/// UsageError for `ray_files` with a folder.
void write_report(const std::filesystem::path& input, const std::filesystem::path& html,
                  const std::vector<std::filesystem::path>& ray_files = {},
                  Progress& progress = no_progress());

}  // namespace lucerna
#pragma GCC visibility pop
