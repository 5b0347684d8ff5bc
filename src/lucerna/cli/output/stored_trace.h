// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lucerna/results/folders/trace_origin.h"
#include "lucerna/trace.h"

namespace lucerna::cli {

/// The trace in `folder` that --resume goes on with; absent if there is none. Throws InputError if it is of
/// another project, of other input files, of another version of the program, or of another seed or sequence
/// than those of --seed and --sequence (empty: any).
std::optional<TraceResult> stored_trace(const std::string& folder, const std::string& seed,
                                        const std::string& sequence, const TraceOrigin& origin);

}  // namespace lucerna::cli
