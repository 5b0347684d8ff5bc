// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

#include "lucerna/source_model.h"

namespace lucerna {

/// What is known of a source model and its file: path, format, method, rays, flux_lm|flux_w, bytes, layers,
/// leaves, warnings, etendue_mm2sr, starting_surface, and how it was chosen. Cost: that of the étendue
/// (model_etendue.h).
nlohmann::ordered_json model_json(const SourceModel& model, const std::filesystem::path& path);

}  // namespace lucerna
