// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

namespace lucerna {

/// Dispersion formulas of the ANSI Glass Format have the numbers 1 to this.
inline constexpr int kAgfFormulas = 13;

/// How many coefficients a formula has.
std::size_t agf_coefficients(int formula);

/// The index by a formula with (at least) its coefficients; not a number where its square is negative.
double agf_index(int formula, std::span<const double> coefficients, double wavelength_um);

}  // namespace lucerna
