// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <toml++/toml.h>

#include <string>
#include <string_view>

namespace lucerna {

/// Parses the text of a TOML file; `name` is for messages. Syntax errors become InputErrors with line and
/// column.
toml::table parse_toml_text(std::string_view text, const std::string& name);

}  // namespace lucerna
