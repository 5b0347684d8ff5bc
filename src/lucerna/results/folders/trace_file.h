// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "lucerna/progress.h"
#include "lucerna/results/folders/trace_origin.h"
#include "lucerna/trace.h"

namespace lucerna {

/// A TraceResult's raw sums and kept rays on disk, so that traces of ranges of rays, made anywhere, can be
/// added later to the bits of one run (`merge`). Little-endian, one zstd frame behind a magic and a version;
/// about a byte per used bin and replicate, and 26 per kept ray. Throws InputError if the file cannot be
/// written.
void write_trace_file(const std::filesystem::path& path, const TraceResult& result,
                      const TraceOrigin& origin);

/// The bytes of that file.
std::string encode_trace(const TraceResult& result, const TraceOrigin& origin);

struct StoredTrace {
  TraceResult result;
  TraceOrigin origin;
};

/// Throws InputError, naming the file and place, on anything that `write_trace_file` cannot have written.
StoredTrace read_trace_file(const std::filesystem::path& path);
/// The same of the bytes; `name` is for messages.
StoredTrace decode_trace(std::string_view bytes, const std::string& name);

/// The name of that file in a trace's folder.
inline constexpr const char* kTraceFileName = "trace.sums";

/// Adds the traces of several ranges of one scene, given in any order: what one run over all of them would
/// have left, to the bit. Each file is read twice, a few results at a time are in memory. Throws InputError,
/// naming the folders, if the traces are of different projects or program versions, cannot be added (`merge`
/// in trace.h), or rays are missing or double between them.
StoredTrace merge_trace_folders(const std::vector<std::filesystem::path>& folders,
                                Progress& progress = no_progress());

}  // namespace lucerna
