// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lucerna/trace/trace_result.h"

namespace lucerna {

/// A TraceResult's raw sums on disk, so that traces of ranges of rays, made anywhere, can be added later to
/// the bits of one run (`merge`). `scene_id` is whatever tells two scenes apart (a hash of the project and
/// its inputs). Kept rays are not stored. Little-endian, one zstd frame behind a magic and a version; about a
/// byte per used bin and replicate. Throws InputError if the file cannot be written.
void write_trace_file(const std::filesystem::path& path, const TraceResult& result,
                      const std::string& scene_id);

struct StoredTrace {
  TraceResult result;
  std::string scene_id;
};

/// Throws InputError, naming the file and place, on anything that `write_trace_file` cannot have written.
StoredTrace read_trace_file(const std::filesystem::path& path);

}  // namespace lucerna
