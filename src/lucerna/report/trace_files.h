// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "lucerna/report/trace_figures.h"
#include "lucerna/trace/project.h"

namespace lucerna {

/// Writes what `trace` leaves in a folder (design.md section 3): `result.json`, `project.toml`, and for each
/// far field NAME `NAME.ldt NAME.ies NAME.csv NAME.svg`. A radiometric far field has no .ldt: the format has
/// no unit for it. Each file appears whole or not at all; returns their names. `result` is what goes into
/// result.json.
std::vector<std::string> write_trace_files(const std::filesystem::path& folder, const Project& project,
                                           const TraceFigures& figures, const nlohmann::ordered_json& result);

/// The table NAME.csv: a header line, then c_deg, gamma_deg, intensity and its standard error per grid angle.
std::string far_field_csv(const FarFieldFigures& figures);

}  // namespace lucerna
