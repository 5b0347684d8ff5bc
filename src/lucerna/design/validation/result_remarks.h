// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "lucerna/design.h"
#include "lucerna/design/problem/target.h"

namespace lucerna {

/// That the error is smaller than what its rays can tell from noise; nothing where it is not.
std::optional<std::string> noise_remark(const DesignError& error);

/// That there was no time for a step, so that nothing was designed; nothing where there was.
std::optional<std::string> no_step_remark(const DesignFindings& result);

/// That much of the error is what the target differs by between its C planes, which a mirror of revolution
/// about the axis lights alike; nothing where that is less than half of it, and for targets on planes.
std::optional<std::string> rings_remark(const DesignTarget& target, const DesignError& error);

}  // namespace lucerna
