// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace lucerna {

/// Decimals that give the largest value `peak` the wanted number of significant digits, between 0 and 9.
int decimals_for(double peak, int digits);

/// A number as photometric files want it: no exponent, no trailing zeros, '.' for the decimals; `decimals` <
/// 0 gives the shortest text that reads back to the same double.
std::string number_text(double value, int decimals);

/// `text` on one line: control characters become blanks, blanks at the ends go.
std::string one_line(std::string_view text);

}  // namespace lucerna
