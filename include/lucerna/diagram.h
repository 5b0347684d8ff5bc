// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>

#include "lucerna/intensity.h"

#pragma GCC visibility push(default)
namespace lucerna {

/// The polar diagram of a light distribution as an SVG document, the way the trade draws it: gamma 0 at the
/// bottom, C0-C180 solid, C90-C270 dashed. With the standard errors of the values (layout of `cd`) their 95 %
/// intervals are drawn as a band. Throws InputError if the grid breaks its rules or the errors are not as
/// many as the values. Thread safe; O(gammas).
[[nodiscard]] std::string polar_diagram(const IntensityDistribution& distribution,
                                        std::span<const double> standard_error_cd = {},
                                        const std::string& title = {});

}  // namespace lucerna
#pragma GCC visibility pop
