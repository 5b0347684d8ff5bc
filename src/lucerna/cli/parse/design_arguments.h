// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "lucerna/cli/parse/command.h"
#include "lucerna/cli/parse/session.h"
#include "lucerna/design/run/design.h"

namespace lucerna::cli {

/// What the options of `design` say, as text.
struct DesignArguments {
  std::string project, output, time, seed = "1", rays, device = "auto", report;
  bool resume = false, tolerances = false, pareto = false, advise = false;
};

/// Adds them to a command, that of the device where there is a choice. `arguments` and `session` must outlive
/// it.
void add_design_options(Command& command, DesignArguments& arguments, Session& session, bool device);

/// The options without accelerator and checkpoint. Throws UsageError on words that are none of what is
/// expected, InputError on too few rays.
DesignOptions design_options(const DesignArguments& arguments);

}  // namespace lucerna::cli
