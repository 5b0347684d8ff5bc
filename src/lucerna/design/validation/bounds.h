// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "lucerna/design/shape/design_shape.h"
#include "lucerna/design/validation/box_error.h"
#include "lucerna/design/validation/source_etendue.h"
#include "lucerna/design/validation/validation.h"

namespace lucerna {

/// The bound from étendue and luminance (Liouville): light that leaves towards some boxes passes an opening
/// of projected area A(direction), so that it has at most the étendue of A over the boxes, and no more flux
/// than the sources' brightest light of that étendue (`curve`, which must not state too much étendue). Of all
/// sets of brightest boxes the one that binds most is taken; within the set and outside of it the deviations
/// are spread as evenly as light could be at best, so that the true least error is larger. A is that of the
/// convex hull of the mirror over its aperture, `height_mm` high along `axis`: opening_mm2 * |cos| +
/// lateral_mm2 * sin. `share`: of the sources' flux in the rectangle (by shape; absolute mode does not use
/// it). Plane targets have no bound (0).
DesignBound etendue_bound(const ErrorBoxes& boxes, std::span<const double> target, TargetMode mode,
                          double share, const EtendueCurve& curve, const Vec3& axis, double opening_mm2,
                          double lateral_mm2);

/// The same for a mirror's sources and aperture, and what its direct light leaves (direct_bound.h): the
/// larger of the two. The height is `shape`'s, the share that of `light`, which is the shape's. The quick
/// curve decides whether étendue bounds anything; the searched one then bounds.
DesignBound design_bound(const ErrorBoxes& boxes, std::span<const double> target, TargetMode mode,
                         const Validation& light, SourceEtendue& etendue, const DesignShape& shape,
                         const Vec3& axis);

}  // namespace lucerna
