// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "lucerna/design/run/design_metrics.h"

namespace lucerna {

/// What design adds to result.json. What is not known is null.
nlohmann::ordered_json design_json(const DesignProblem& problem, const DesignResult& result,
                                   const DesignMetrics& figures);

/// The table of target against result, losses, limits and tolerances for people, one line an entry.
std::vector<std::string> design_summary(const DesignProblem& problem, const DesignResult& result,
                                        const DesignMetrics& figures);

}  // namespace lucerna
