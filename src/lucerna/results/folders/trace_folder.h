// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/intensity.h"

namespace lucerna {

/// One far field of a trace, as its NAME.csv has it.
struct FarFieldTable {
  std::string name;
  IntensityDistribution distribution;
  /// Standard error of each value; empty if it is not known.
  std::vector<double> standard_error;
  /// Of the whole flux; nothing if it is not known.
  std::optional<double> flux_standard_error{};
};

/// One plane or luminance image of a trace, as its NAME.csv has it.
struct PlaneTable {
  std::string name;
  /// Luminance (seen from a direction or a point), or illuminance.
  bool luminance = false;
  FluxUnit unit = FluxUnit::lumen;
  /// "lx", "cd/m2", "W/m2" or "W/(m2 sr)".
  std::string value_unit;
  /// Middles of the cells in the grid's frame (x to the right, y up for who looks at the lit side, or from
  /// where it is seen); evenly spaced, ascending.
  std::vector<double> x_mm, y_mm;
  /// Numbered iy * x_mm.size() + ix.
  std::vector<double> value;
  /// Standard error of each value; empty if it is not known.
  std::vector<double> standard_error;
};

/// What `trace` left in a folder, read back: all that a report needs.
// A JSON value checks itself when moved. NOLINTNEXTLINE(bugprone-exception-escape)
struct TraceFolder {
  std::filesystem::path path;
  /// result.json, whole.
  nlohmann::ordered_json result;
  /// project.toml, whole.
  std::string project;
  /// In the order of result.json's `detectors`.
  std::vector<FarFieldTable> far_fields;
  /// The `plane` and `luminance` entries, in the order of result.json's `detectors`.
  std::vector<PlaneTable> planes;
};

/// Reads result.json, project.toml and the tables of the detectors (far field, plane, luminance; ray files
/// are left alone). Throws InputError with file, place, found and expected if one is missing, is no result of
/// `lucerna trace`, or has another schema version.
TraceFolder read_trace_folder(const std::filesystem::path& folder);

/// The inverse of `far_field_csv` (trace_files.h): values to the digits of the file. `file` names it in
/// errors. Throws InputError with the line if a number, a column or a grid angle is missing. O(bytes).
FarFieldTable far_field_table(std::string_view csv, const std::string& file);

/// The inverse of `plane_csv` (trace_files.h); errors alike, also for rows that are no full grid. O(bytes).
PlaneTable plane_table(std::string_view csv, const std::string& file);

}  // namespace lucerna
