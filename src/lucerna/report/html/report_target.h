// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/run/design_problem.h"
#include "lucerna/report/html/html_page.h"
#include "lucerna/results/folders/trace_folder.h"

namespace lucerna {

/// The section "target": what was wanted against what was found, and their difference; directions for a light
/// distribution, the rectangle for a plane. In shape mode the target is scaled to fit best.
void add_target_section(HtmlPage& page, const DesignProblem& problem, const TraceFolder& folder);

}  // namespace lucerna
