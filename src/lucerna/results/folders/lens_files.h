// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/design/run/lens_run.h"

namespace lucerna {

/// What a design of a lens that is still running leaves after every step, each file whole at any moment:
/// `history.csv` and `lens.toml` (the best so far as a project that `trace` takes).
void write_lens_progress(const std::filesystem::path& folder, const LensProblem& problem,
                         const ShapedLens& best, std::string_view history);

/// Writes all that a design of a lens leaves in a folder: the above; `lens.step .stl .obj`, and `.dxf
/// .csv` of one of revolution (those of another lens are removed), in its own frame, mm; and what `trace`
/// leaves, `result.json` last. `traced` is the trace that `figures` are of. Returns the names.
std::vector<std::string> write_lens_files(const std::filesystem::path& folder, const LensProblem& problem,
                                          const LensResult& result, const DesignMetrics& figures,
                                          const TraceResult& traced, std::string_view history,
                                          const nlohmann::ordered_json& json);

}  // namespace lucerna
