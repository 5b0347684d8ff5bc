// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/report/html/report_parts.h"

namespace lucerna {

/// result.json's zones as a table; empty if it has none.
std::string zones_html(const ResultFigures& result);

}  // namespace lucerna
