// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lucerna/project.h"

namespace lucerna::test {

/// The scene of a project file.
inline Scene project_scene(const std::filesystem::path& path) { return read_project(path).scene; }

}  // namespace lucerna::test
