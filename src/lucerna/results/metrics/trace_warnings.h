// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "lucerna/scene.h"
#include "lucerna/trace_metrics.h"

namespace lucerna {

/// What a reader of a trace's figures and files may be misled by, a sentence each: a far field whose grid is
/// too coarse for its peak. Looks at figures that are there; thread safe.
std::vector<std::string> trace_warnings(const TraceMetrics& figures);

/// The same with the scene that was traced: also mirrors that no light reaches, or at their backs alone,
/// and rays that are too few for any error. Begins with what was odd in the files of its project
/// (Project::warnings).
std::vector<std::string> trace_warnings(const TraceMetrics& figures, const Scene& scene,
                                        std::vector<std::string> of_project = {});

}  // namespace lucerna
