// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace lucerna::cli {

/// For commands that take rays. Throws InputError for a file of another kind that the program knows: a source
/// model, a light distribution, a project. Says what it is, and which commands take it. Throws too for a file
/// that is named as a light distribution and has nothing of one. Anything else passes: the reader of rays
/// says what is wrong with it.
void require_ray_file(const std::filesystem::path& path);

/// Whether the name says that it is a project (.toml).
bool is_project_file(const std::filesystem::path& path);

}  // namespace lucerna::cli
