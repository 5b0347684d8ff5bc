// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace lucerna::led_emitter {

/// The emitter `led` (source.h): dies of 1 mm on a square of this pitch, and their shares of what the
/// package does not give off.
inline constexpr double kPitchMm = 1.1, kPackageRadiusMm = 2.5, kStrayShare = 0.01;
inline constexpr std::array<double, 4> kDieShare{0.25, 0.2375, 0.2625, 0.25};

}  // namespace lucerna::led_emitter
