// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace lucerna {

/// Code points up to the first zero as UTF-8; what is no Unicode scalar value becomes U+FFFD.
std::string utf8_from_utf32(std::span<const std::uint32_t> code_points);

/// Code points of a UTF-8 text; broken sequences become U+FFFD.
std::vector<std::uint32_t> utf32_from_utf8(std::string_view text);

}  // namespace lucerna
