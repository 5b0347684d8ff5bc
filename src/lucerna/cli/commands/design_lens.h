// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "lucerna/cli/parse/session.h"
#include "lucerna/design.h"
#include "lucerna/project.h"

namespace lucerna::cli {

/// `lucerna design` of a project with `free_sides`: a lens. `report` may be empty.
void design_lens_command(Project project, const std::string& name, const DesignSettings& settings,
                         const std::filesystem::path& folder, const std::string& report, Session& session,
                         int& exit_code);

}  // namespace lucerna::cli
