// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "lucerna/design/problem/design_limits.h"

namespace lucerna {

/// The room that a zone and its clearance take over one place of an aperture.
struct ZoneColumn {
  double x_mm = 0.0, y_mm = 0.0;
  double low_mm = 0.0, high_mm = 0.0;
};

/// The zone, thickened by its clearance, over a fine grid of places of the aperture (of one radius, turned to
/// y = 0, for `revolution`: then a column holds all that the zone has at its distance from the axis). The
/// zone counts as convex along the axis: between its lowest and highest point over a place all is taken.
/// Empty if no part of it is over the aperture. Cost: places times points of the zone near them.
std::vector<ZoneColumn> zone_columns(const KeepOut& zone, const Aperture& aperture, bool revolution);

/// Points that cover a mesh's triangles no farther than `spacing_mm` apart, corners and edges included.
std::vector<Vec3> surface_points(const Mesh& mesh, double spacing_mm);

}  // namespace lucerna
