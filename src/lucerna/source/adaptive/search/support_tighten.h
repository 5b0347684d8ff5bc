// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "lucerna/rays.h"
#include "lucerna/source/adaptive/charts/support.h"

namespace lucerna {

/// A sphere or cylinder about the same centre and axis that is just large enough: all but about `missed` of
/// the rays' lines (0 <= missed < 1, by number) meet it, of a cylinder its lateral surface's radius and
/// either end by itself. A search by likelihood cannot find such edges well: too large costs next to nothing
/// there, too small much. Nothing for other supports, and where no line comes near. Cost: O(rays).
std::optional<Support> tightened(const Support& support, const RayBlock& rays, double missed);

}  // namespace lucerna
