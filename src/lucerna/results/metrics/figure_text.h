// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace lucerna {

/// What stands for a figure that is not there.
inline constexpr const char* kNoFigure = "–";

/// A figure for people: 5 significant digits, no exponent between 1e-4 and 1e9; a dash if not finite.
std::string figure_text(double value);

/// "823.1 ± 0.3": as many digits as the standard error supports (two of its own). As `figure_text(value)`
/// where the error is not known (NaN) or 0.
std::string figure_text(double value, double standard_error);

}  // namespace lucerna
