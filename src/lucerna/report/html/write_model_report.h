// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/source_model.h"

namespace lucerna {

/// Writes the report of the model in the file `model_path` to `html`, against the rays of `ray_files` (none:
/// without a comparison). `json` is the result that the page shows (model_report_html). Of large files 4 M
/// rays are taken together (thinned_ray_set).
void write_model_report(const SourceModel& model, const std::filesystem::path& model_path,
                        const std::vector<std::filesystem::path>& ray_files, nlohmann::ordered_json json,
                        const std::filesystem::path& html, Progress& progress = no_progress());

}  // namespace lucerna
