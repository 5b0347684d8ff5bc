// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace lucerna {

/// Lengths are in mm, illuminance and luminance by m^2.
inline constexpr double kSquareMillimetresPerSquareMetre = 1e6;

}  // namespace lucerna
