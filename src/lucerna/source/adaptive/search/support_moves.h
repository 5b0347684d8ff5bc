// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/source/adaptive/charts/support.h"

namespace lucerna {

/// Ways in which a support can be changed: 0-2 moved along its own x, y, z; 3-5 turned about them; 6 another
/// radius, 7 another length; 8-10 its dome moved along x, y, z; 11 a stronger dome, 12 one of another index.
inline constexpr int kSupportMoves = 13;

/// One step of a support, by `length_mm` or by `angle` (radians; of sizes: the logarithm), whichever the move
/// has. Nothing for moves that change nothing or lead to a support that does not exist. `moved` undoes itself
/// with both signs turned, to first order.
std::optional<Support> moved(const Support& s, int move, double length_mm, double angle);

}  // namespace lucerna
