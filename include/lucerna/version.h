// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#pragma GCC visibility push(default)
namespace lucerna {

/// The program's version, as CMake's project() has it.
std::string_view version();

/// Version of the layout of every JSON result; grows when a key changes its meaning or goes.
inline constexpr int kJsonSchemaVersion = 5;

}  // namespace lucerna
#pragma GCC visibility pop
