// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lucerna {

/// UTF-8 text made safe for element content and quoted attributes; control characters are dropped.
std::string html_escaped(std::string_view text);

}  // namespace lucerna
