// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/constraints/limits.h"
#include "lucerna/design/evaluation/design_rays.h"

namespace lucerna {

/// So much of the light may start behind a designed mirror beyond what starts behind the given one.
inline constexpr double kMaxBehind = 1e-3;

/// Share of the light that starts over the mirror's aperture and behind it, by the first 4096 rays.
double share_behind(const DesignShape& shape, const DesignRays& rays);

/// Heights that keep a mirror below the places where those rays start, in its frame: the source is a body
/// too. Of starts above one another the lower ones. Where `given` has passed it there is no bound, and none
/// is nearer to `given` than costs begin.
std::vector<HeightBounds> heights_below_source(const DesignShape& given, const DesignRays& rays);

}  // namespace lucerna
