// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace lucerna {

/// Adds what a reader warned of to `warnings`, each behind the file's name: "led.dat: line 1: ...".
void add_named_warnings(const std::filesystem::path& file, const std::vector<std::string>& found,
                        std::vector<std::string>& warnings);

}  // namespace lucerna
