// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/cad.h"
#include "lucerna/results/json/design_json.h"

namespace lucerna {

/// What a design that is still running leaves after every step, each file whole at any moment, the checkpoint
/// last: `history.csv`, `reflector.toml` (the best so far as a project that `trace` takes) and `checkpoint`.
void write_design_progress(const std::filesystem::path& folder, const DesignProblem& problem,
                           const DesignShape& best, std::string_view history, std::string_view checkpoint);

/// A folder that a design is to go on from: its checkpoint (empty if it never got so far) and the lines of
/// its history up to there. Throws InputError if a file cannot be read.
struct DesignProgress {
  std::string checkpoint, history;
};
DesignProgress read_design_progress(const std::filesystem::path& folder);

/// Writes the mirror as `reflector.step .stl .obj .dxf .csv` (in its own frame, mm; tolerances as
/// `cad_mesh_within`, the STL file's is `stl`). Throws InputError as the exporters do. Returns the names.
std::vector<std::string> write_reflector_files(const std::filesystem::path& folder,
                                               const Reflector& reflector, CadTolerance stl);

/// Writes all that `design` leaves in a folder: the above, `tolerances.csv` where there
/// was a sweep (that of another mirror is removed), and what `trace` leaves, `result.json` last. `traced` is
/// the trace that `figures` are of.
std::vector<std::string> write_design_files(const std::filesystem::path& folder, const DesignProblem& problem,
                                            const DesignResult& result, const DesignMetrics& figures,
                                            const TraceResult& traced, std::string_view history,
                                            const nlohmann::ordered_json& json);

}  // namespace lucerna
