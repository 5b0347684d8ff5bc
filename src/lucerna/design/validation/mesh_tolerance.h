// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/cad.h"
#include "lucerna/design/problem/target_rectangle.h"

namespace lucerna {

/// What the facets of a mirror at `mirror_mm` (luminaire frame) may be off by, where its light is measured in
/// 48 x 48 boxes of `rectangle`: a fifth of a box as the mirror sees it, at most kOpticalTolerance's slope
/// and at least half of that. Light is off by up to twice the slope, and what that does to the error goes
/// with its square (docs/benchmarks/design.md).
CadTolerance mesh_tolerance(const TargetRectangle& rectangle, const Vec3& mirror_mm);

}  // namespace lucerna
