// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/problem/target.h"
#include "lucerna/report/html/html_page.h"
#include "lucerna/results/folders/trace_folder.h"
#include "lucerna/scene.h"

namespace lucerna {

/// The section "target": what was wanted against what was found, and their difference; directions for a light
/// distribution, the rectangle for a plane, which `scene` is traced onto. In shape mode the target is scaled
/// to fit best.
void add_target_section(HtmlPage& page, const DesignTarget& target, const Scene& scene,
                        const TraceFolder& folder);

}  // namespace lucerna
