// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// How light counts against a target.
enum class TargetMode {
  shape,     ///< only the distribution: the result is scaled to fit best
  absolute,  ///< as it is
};

/// What light beside the target's rectangle costs in shape mode: so many times the square of the missing
/// share, beside the squared error. At 0.1 a tenth of the light counts as an error of 3.2 %.
inline constexpr double kLightWeight = 0.1;

}  // namespace lucerna
