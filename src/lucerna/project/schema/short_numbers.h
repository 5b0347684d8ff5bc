// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lucerna {

/// TOML with each number in the fewest digits that say the same: 0.905 where a writer of TOML put
/// 0.90500000000000003. Strings stay as they are, and so do keys, unless one reads as such a number.
/// O(bytes).
std::string short_numbers(std::string_view toml);

}  // namespace lucerna
