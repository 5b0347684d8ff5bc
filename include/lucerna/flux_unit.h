// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

#pragma GCC visibility push(default)
namespace lucerna {

/// What a flux counts: luminous flux (lm) or radiant flux (W). The two are never added or converted silently.
enum class FluxUnit { lumen, watt };

/// "lm" or "W".
constexpr std::string_view symbol(FluxUnit unit) { return unit == FluxUnit::lumen ? "lm" : "W"; }

/// That of an intensity: "cd" or "W/sr".
constexpr std::string_view intensity_symbol(FluxUnit unit) { return unit == FluxUnit::lumen ? "cd" : "W/sr"; }

}  // namespace lucerna
#pragma GCC visibility pop
