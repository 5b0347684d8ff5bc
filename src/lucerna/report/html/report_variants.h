// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/report/html/report_parts.h"

namespace lucerna {

/// What the result warns of, a paragraph each; empty if of nothing.
std::string warnings_html(const ResultFigures& result);

/// The mirrors beside the designed one: the trade between error and light (`--pareto`), what was tried as
/// advice, and what tolerances change; a heading and a table each. Empty if the design has none of them.
std::string variants_html(const ResultFigures& result);

}  // namespace lucerna
