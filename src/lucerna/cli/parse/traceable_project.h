// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "lucerna/progress.h"
#include "lucerna/project.h"

namespace lucerna::cli {

/// Reads a project whose clear bodies are apart from each other and from all else, as `trace` needs them. Its
/// warnings name mirrors and bodies that reach into a cover glass.
/// Throws InputError as read_project does, or naming the file and two bodies that are not.
Project read_traceable_project(const std::filesystem::path& path, Progress& progress = no_progress());

}  // namespace lucerna::cli
