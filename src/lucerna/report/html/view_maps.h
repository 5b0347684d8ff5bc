// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/ray_comparison.h"
#include "lucerna/report/html/html_page.h"

namespace lucerna {

/// Maps of one view of a reference, of a test and of their difference, all in per cent of the flux per cell;
/// the four-dimensional view as 8 x 8 places of 8 x 8 directions. For the page's lists (grid_map.h).
std::string view_metrics(HtmlPage& page, ViewKind kind, const ViewCounts& reference, const ViewCounts& test);

}  // namespace lucerna
