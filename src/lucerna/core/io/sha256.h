// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lucerna {

/// SHA-256 of a text, 64 hexadecimal digits, as `sha256_of_file` (file.h) gives them.
std::string sha256_of_text(std::string_view text);

}  // namespace lucerna
