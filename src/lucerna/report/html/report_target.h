// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/problem/target.h"
#include "lucerna/report/html/html_page.h"
#include "lucerna/report/html/report_parts.h"
#include "lucerna/results/folders/trace_folder.h"

namespace lucerna {

/// The section "target": what was wanted against what was found, and their difference; directions for a light
/// distribution, the rectangle for a plane, which the folder has a detector of. In shape mode the target is
/// scaled as the design was compared with it.
void add_target_section(HtmlPage& page, const DesignTarget& target, const ResultFigures& result,
                        const TraceFolder& folder);

}  // namespace lucerna
