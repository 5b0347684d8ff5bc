// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/report/html/grid_map.h"
#include "lucerna/report/html/report_parts.h"
#include "lucerna/results/folders/trace_folder.h"

namespace lucerna {

/// A section for every plane, luminance image and ray file among a trace's detectors: maps, isolux lines,
/// figures with their errors. `planes` as in TraceFolder.
void add_plane_sections(HtmlPage& page, const ResultFigures& result, const std::vector<PlaneTable>& planes);

/// The map of a plane or luminance image.
GridMap plane_map(const PlaneTable& plane);

}  // namespace lucerna
