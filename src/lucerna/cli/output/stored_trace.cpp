// SPDX-License-Identifier: Apache-2.0
#include "lucerna/cli/output/stored_trace.h"

#include <fmt/format.h>

#include <filesystem>
#include <utility>

#include "lucerna/cli/parse/arguments.h"
#include "lucerna/core/io/error.h"
#include "lucerna/random.h"
#include "lucerna/results/folders/trace_file.h"

namespace lucerna::cli {

std::optional<TraceResult> stored_trace(const std::string& folder, const std::string& seed,
                                        const std::string& sequence, const TraceOrigin& origin) {
  const std::filesystem::path file = std::filesystem::path(folder) / kTraceFileName;
  if (!std::filesystem::exists(file)) return std::nullopt;
  StoredTrace stored = read_trace_file(file);
  if (stored.origin.scene_id != origin.scene_id)
    throw InputError(fmt::format("{}: is a trace of another project, or of other input files", folder));
  if (stored.origin.program_version != origin.program_version) {
    throw InputError(fmt::format("{}: was traced by lucerna {}, this is {}", folder,
                                 stored.origin.program_version, origin.program_version));
  }
  if (!seed.empty() && parse_count(seed) != stored.result.seed) {
    throw InputError(
        fmt::format("{}: was traced with seed {}, found --seed {}", folder, stored.result.seed, seed));
  }
  if (!sequence.empty() && sequence_kind(sequence) != stored.result.sequence) {
    throw InputError(fmt::format("{}: was traced with sequence {}, found --sequence {}", folder,
                                 to_string(stored.result.sequence), sequence));
  }
  return std::move(stored.result);
}

}  // namespace lucerna::cli
