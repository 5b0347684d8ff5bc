// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

/// The source tree as the checks on it see it.
namespace lucerna::test {

/// Headers and sources of the library and the program, tests beside them included.
std::vector<std::filesystem::path> source_files();

bool is_public(const std::filesystem::path& file);
bool is_test(const std::filesystem::path& file);

/// Where a private file is below its top folder: "trace/kernels/kernel.h".
std::filesystem::path place_of(const std::filesystem::path& file);

std::vector<std::string> lines_of(const std::filesystem::path& file);

}  // namespace lucerna::test
