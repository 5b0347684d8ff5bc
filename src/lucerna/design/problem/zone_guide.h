// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lucerna/design/problem/zone_cells.h"
#include "lucerna/intensity.h"
#include "lucerna/photometry/formats/illuminance_map.h"

namespace lucerna {

/// A smooth light that zones with a minimum suggest: a little above the minimum in each of them, level
/// between near ones, falling off around them, below the maximum of every zone. A target of zones alone is
/// begun with it; what counts in the end are the zones. By shape only.
IntensityDistribution guide_distribution(const ZoneCells& zones, FluxUnit unit);
/// The same over the rectangle of a plane target.
IlluminanceMap guide_map(const ZoneCells& zones, double size_x_mm, double size_y_mm);

}  // namespace lucerna
